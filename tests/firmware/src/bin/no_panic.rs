//! A proof by the linker that tick path and store cannot panic: the panic handler
//! calls a function that does not exist, so the image links only if no panic
//! can be reached. With the feature `negative_control` it must not link.

#![no_std]
#![no_main]

use core::hint::black_box;
use core::panic::PanicInfo;

use cortex_m_rt::entry;
use cortex_m_semihosting::debug;
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use truearm::blob::{Acceptance, AcceptanceError, Blob, DecodeError};
use truearm::check_point::CheckPoint;
use truearm::drift::{DriftWatch, FalseAlarms};
use truearm::parameters::Parameter;
use truearm::reidentify::Reidentify;
use truearm::solve::{NormalEquations, StreamingTikhonov};
use truearm::store::{GeometryError, NorSlots, Opened, Slot, Store, StoreError, Stored};
use truearm::streaming::{self, Lambda};
use truearm::{Approach, Arm, Compensator, Pose, Settings, State, Task};

/// What a controller calls, on values the compiler knows nothing about.
fn tick_path(bytes: &[u8], q: &[f32; 6]) -> Result<(), AcceptanceError> {
    let mine =
        Acceptance::of(black_box(1), 6).with_key(black_box([3; 32])).not_before(black_box(2));
    let blob = mine.check(black_box(bytes))?;
    let parameters = blob.parameters::<f32, 6>()?;
    let arm = Arm::new(black_box(&parameters));
    black_box(arm.real_pose(black_box(q)));
    let state = State { approach: q.map(Approach::of_motion), payload: q[0], temperature: q[1] };
    black_box(arm.real_pose_in(black_box(q), black_box(&state)));
    black_box(arm.deflection(black_box(q), black_box(&state)));
    if let Some(covariance) = blob.covariance() {
        let _ = black_box(covariance.point_sigma(black_box(&arm), black_box(q), black_box(&state)));
    }
    black_box(arm.with_tool(*black_box(arm.nominal().tool())));
    black_box(arm.covers(black_box(q)));
    black_box(arm.real().jacobian(black_box(q)));
    for task in [Task::Position, Task::Pose] {
        let settings = black_box(Settings::new(task));
        if let Ok(mut compensator) = Compensator::new(arm.clone(), settings, black_box(q)) {
            compensator.set_active(black_box(true));
            black_box(compensator.tick(black_box(q), black_box(&state)));
            compensator.set_arm(arm.clone());
        }
    }
    #[cfg(feature = "negative_control")]
    black_box(bytes[black_box(7)]);
    Ok(())
}

/// Identification and drift watch on the controller, likewise.
fn identification(bytes: &[u8], q: &[f32; 6]) -> Result<(), DecodeError> {
    let parameters = Blob::check(black_box(bytes))?.parameters::<f32, 6>()?;
    let point = CheckPoint::plain(*q, Pose::translation(q[0], q[1], q[2]).translation, q[3]);
    let points = [*black_box(&point); 10];
    let [x, y, z] = Parameter::TOOL;
    let chosen = black_box([Parameter::JointOffset(1), Parameter::Term(2), x, y, z]);
    let _ = black_box(Reidentify::new(&parameters, chosen, q[0]).run(&parameters, &points));
    for frame in [Parameter::STATION, Parameter::BASE] {
        let _ = black_box(Reidentify::new(&parameters, frame, q[0]).run(&parameters, &points));
    }
    let settings = streaming::Settings::new(&parameters, chosen, q[0]);
    if let Ok(mut stream) = settings.start(&parameters) {
        let _ = black_box(stream.push(black_box(&point)));
        if let Ok(found) = stream.identified(black_box(Lambda::TwoStep)) {
            stream.relinearise(black_box(&found));
        }
    }
    let arm = Arm::new(&parameters);
    if let Ok(mut watch) = DriftWatch::<f32, 6>::new(q[1], FalseAlarms::default()) {
        let _ = black_box(watch.push(&arm, black_box(&point), &point.point));
        black_box(watch.suspect());
    }
    let mut normal = NormalEquations::<f32, 6>::new();
    let _ = black_box(normal.push(q, q[1]));
    let _ = black_box(normal.solve(q[2], black_box(q)));
    if let Ok(mut stream) = StreamingTikhonov::<f32, 30>::new(black_box(5), q[2]) {
        let _ = black_box(stream.push(black_box(&[[q[0]; 3]; 30]), black_box(&[q[1]; 3])));
        let _ = black_box(stream.push(black_box(&[[q[0]]; 30]), black_box(&[q[1]])));
        let scale = black_box([q[3]; 30]);
        let _ = black_box(stream.choose(&scale));
        if let Ok(all) = stream.all() {
            let _ = black_box(all.solve(q[4], &scale));
            let _ = black_box(all.variances(q[4], &scale));
        }
    }
    Ok(())
}

/// A flash of which the compiler knows nothing.
struct Flash;

impl ErrorType for Flash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    #[inline(never)]
    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        black_box((offset, bytes));
        black_box(Ok(()))
    }

    fn capacity(&self) -> usize {
        black_box(8192)
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = 4096;

    #[inline(never)]
    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        black_box((from, to));
        black_box(Ok(()))
    }

    #[inline(never)]
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        black_box((offset, bytes));
        black_box(Ok(()))
    }
}

type Slots = NorSlots<Flash>;
type Open<'b> = (Store<Slots>, Opened<'b, NorFlashErrorKind>);

// The names of these three are what xtask sums up as the store's text.

#[inline(never)]
fn store_slots(starts: [u32; 2], size: u32) -> Result<Slots, GeometryError> {
    NorSlots::new(Flash, starts, size)
}

#[inline(never)]
fn store_open<'b>(slots: Slots, buffer: &'b mut [u8]) -> Result<Open<'b>, GeometryError> {
    Store::open(slots, buffer, Acceptance::of(black_box(1), 6))
}

#[inline(never)]
fn store_store(
    store: &mut Store<Slots>,
    bytes: &[u8],
) -> Result<Stored, StoreError<NorFlashErrorKind>> {
    store.store(bytes)
}

/// What a controller calls at power-up and when it is given new parameters.
fn store_path(bytes: &[u8], buffer: &mut [u8]) -> Result<(), GeometryError> {
    let slots = store_slots(black_box([0, 4096]), black_box(4096))?;
    let (mut store, opened) = store_open(slots, black_box(buffer))?;
    black_box(opened);
    let _ = black_box(store_store(&mut store, black_box(bytes)));
    let _ = black_box(store.discard(black_box(Slot::A)));
    black_box(store.live());
    Ok(())
}

#[entry]
fn main() -> ! {
    let _ = identification(black_box(&[0; 4096]), black_box(&[0.0; 6]));
    let _ = black_box(store_path(black_box(&[0; 4096]), black_box(&mut [0; 4096])));
    let status = match tick_path(black_box(&[0; 4096]), black_box(&[0.0; 6])) {
        Ok(()) => debug::EXIT_SUCCESS,
        Err(_) => debug::EXIT_FAILURE,
    };
    debug::exit(status);
    loop {
        cortex_m::asm::wfi();
    }
}

unsafe extern "C" {
    fn truearm_panic_is_reachable() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    // SAFETY: never called: the function does not exist, and nothing links
    // that could get here.
    unsafe { truearm_panic_is_reachable() }
}
