//! C interface of truearm: six joints, single precision, memory of the caller,
//! no heap, no panic. The header `include/truearm.h` is generated from this crate
//! (`cargo xtask c --header`) and tells a C programmer everything; a test holds
//! the two in step.

#![cfg_attr(not(test), no_std)]

mod convert;
mod pointer;
mod poses;
#[cfg(test)]
mod tests;
mod tick;
mod types;

use core::ffi::c_void;

use truearm::blob::{Acceptance, AcceptanceError, Covariance};
use truearm::{Arm6, Compensator, Pose, ThermalLag};

use convert::settings_of;
use pointer::{handle, input, writable};
pub use poses::{truearm_nominal_pose, truearm_point_sigma, truearm_real_pose};
pub use tick::{truearm_arm_temperature, truearm_default_state, truearm_tick};
pub use types::{
    TRUEARM_JOINTS, TruearmApproach, TruearmError, TruearmPose, TruearmSettings, TruearmState,
    TruearmStatus, TruearmTask, TruearmTick,
};

/// Version of this interface: changes whenever a function, a structure or the
/// memory it needs does.
pub const TRUEARM_VERSION: u32 = 6;
/// Bytes of memory that `truearm_init` needs.
pub const TRUEARM_MEMORY_SIZE: usize = 4288;
/// Alignment of that memory.
pub const TRUEARM_MEMORY_ALIGN: usize = 8;

// The macros of the header against what is needed, most where pointers are long.
const _: () = assert!(size_of::<Truearm>() <= TRUEARM_MEMORY_SIZE);
const _: () = assert!(TRUEARM_MEMORY_SIZE < size_of::<Truearm>() + 192);
const _: () = assert!(align_of::<Truearm>() <= TRUEARM_MEMORY_ALIGN);

/// Written by `truearm_init`: "TARM" and the version.
const INITIALISED: u64 = 0x5441_524d_0000_0000 | TRUEARM_VERSION as u64;

/// One arm. Opaque: it lies in the caller's memory, is never freed and may be
/// given up by no longer using it. Not to be used by two threads or by an
/// interrupt and what it interrupts at once.
pub struct Truearm {
    initialised: u64,
    covariance: Option<Covariance<'static>>,
    /// Of the arm that is loaded.
    lag: ThermalLag<f32>,
    compensator: Option<Compensation>,
}

type Compensation = Compensator<'static, f32, TRUEARM_JOINTS>;
type Result<T = ()> = core::result::Result<T, TruearmError>;

fn code(result: Result) -> TruearmError {
    match result {
        Ok(()) => TruearmError::Ok,
        Err(error) => error,
    }
}

impl Truearm {
    fn arm(&self) -> Result<&Arm6<'static, f32>> {
        Ok(self.compensator.as_ref().ok_or(TruearmError::NotLoaded)?.arm())
    }

    /// What a tick takes.
    fn ticking(&mut self) -> Result<&mut Compensation> {
        self.compensator.as_mut().ok_or(TruearmError::NotLoaded)
    }

    /// A new compensator, switched off; nothing changes on an error.
    fn start(
        &mut self,
        arm: Arm6<'static, f32>,
        settings: &TruearmSettings,
        joints: &[f32; TRUEARM_JOINTS],
    ) -> Result {
        let settings = settings_of(settings)?;
        let compensator =
            Compensator::new(arm, settings, joints).map_err(|_| TruearmError::BadSetting)?;
        self.compensator = Some(compensator);
        Ok(())
    }
}

/// What starting over needs: an arm that is at rest, settings and joints.
///
/// # Safety
/// Every pointer is NULL or as typed.
unsafe fn at_rest<'a>(
    arm: *mut Truearm,
    settings: *const TruearmSettings,
    joints: *const f32,
) -> Result<(&'a mut Truearm, TruearmSettings, [f32; TRUEARM_JOINTS])> {
    // SAFETY: the caller's promise.
    let all = unsafe { (handle(arm)?, input(settings)?, input(joints.cast())?) };
    let idle = all.0.compensator.as_ref().is_none_or(Compensator::is_idle);
    if idle { Ok(all) } else { Err(TruearmError::Active) }
}

/// Prepares `memory` and gives the arm in it. First call of all.
///
/// `version` must be TRUEARM_VERSION of the header the program was compiled
/// with, `size` at least TRUEARM_MEMORY_SIZE; `memory` aligned to
/// TRUEARM_MEMORY_ALIGN, kept and left alone as long as the arm is used.
///
/// # Safety
/// `memory` is NULL or `size` writable bytes, `arm` is NULL or writable.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn truearm_init(
    version: u32,
    memory: *mut c_void,
    size: usize,
    arm: *mut *mut Truearm,
) -> TruearmError {
    code((|| {
        if version != TRUEARM_VERSION {
            return Err(TruearmError::Version);
        }
        writable(arm)?;
        if memory.is_null() {
            return Err(TruearmError::Null);
        }
        if size < TRUEARM_MEMORY_SIZE {
            return Err(TruearmError::MemorySize);
        }
        if !memory.addr().is_multiple_of(TRUEARM_MEMORY_ALIGN) {
            return Err(TruearmError::Alignment);
        }
        let place = memory.cast::<Truearm>();
        let empty = Truearm {
            initialised: INITIALISED,
            covariance: None,
            lag: ThermalLag::new(0.0),
            compensator: None,
        };
        // SAFETY: the caller's promise; size and alignment have been checked.
        unsafe {
            place.write(empty);
            arm.write(place);
        }
        Ok(())
    })())
}

/// Reads a parameter blob (as `truearm pack` writes it), checked byte by byte,
/// and starts over with its arm, switched off. What lies behind the blob is
/// ignored, so that a whole memory slot may be given. It must stay there as long
/// as the arm is used: tables of effects and the covariance are not copied.
///
/// The tool is that of `truearm_set_tool`, kept from parameters to parameters. Until that
/// was called it is the point that was measured (the reflector of the calibration), and
/// ticks correct that one.
///
/// `robot_id` is the id of this robot, as `truearm inspect` prints it: another
/// robot's blob is refused. `joints` are where the arm stands, rad. Refused
/// while compensation is on or being faded out; on an error nothing changes.
///
/// Takes 21 KB of stack on a Cortex-M4F: call it where there is room.
///
/// # Safety
/// `blob` is NULL or `size` bytes, readable and unchanged as long as the arm is
/// used; other pointers NULL or as typed.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn truearm_load(
    arm: *mut Truearm,
    blob: *const u8,
    size: usize,
    robot_id: u64,
    settings: *const TruearmSettings,
    joints: *const f32,
) -> TruearmError {
    code((|| {
        // SAFETY: the caller's promise.
        let (this, settings, joints) = unsafe { at_rest(arm, settings, joints)? };
        if blob.is_null() {
            return Err(TruearmError::Null);
        }
        // SAFETY: the caller's promise; bytes need no alignment.
        let bytes: &'static [u8] = unsafe { core::slice::from_raw_parts(blob, size) };
        let mine = Acceptance::of(robot_id, TRUEARM_JOINTS);
        let blob = mine.check(bytes).map_err(|refusal| match refusal {
            AcceptanceError::WrongRobot { .. } => TruearmError::OtherRobot,
            AcceptanceError::WrongJoints { .. } => TruearmError::OtherArm,
            _ => TruearmError::BadBlob,
        })?;
        let parameters = blob.parameters().map_err(|_| TruearmError::OtherArm)?;
        let next = match &this.compensator {
            Some(running) => running.arm().with_parameters(&parameters),
            None => Arm6::new(&parameters),
        };
        this.start(next, &settings, &joints)?;
        this.covariance = blob.covariance();
        // An arm is as warm as it was before parameters came that say the same of it.
        let lag = this.arm()?.thermal_lag();
        if lag.time_constant() != this.lag.time_constant() {
            this.lag = lag;
        }
        Ok(())
    })())
}

/// The usual settings for an arm of about a metre, for a task of
/// `TruearmTask`.
///
/// # Safety
/// `settings` is NULL or writable.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn truearm_default_settings(
    task: u8,
    settings: *mut TruearmSettings,
) -> TruearmError {
    code((|| {
        writable(settings)?;
        let usual = convert::usual(task)?;
        // SAFETY: the caller's promise; not NULL and aligned.
        unsafe { settings.write(usual) };
        Ok(())
    })())
}

/// Starts over with other settings, switched off; `joints` are where the arm
/// stands, rad. Refused while compensation is on or being faded out.
///
/// # Safety
/// Every pointer is NULL or as typed.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn truearm_set_settings(
    arm: *mut Truearm,
    settings: *const TruearmSettings,
    joints: *const f32,
) -> TruearmError {
    code((|| {
        // SAFETY: the caller's promise.
        let (this, settings, joints) = unsafe { at_rest(arm, settings, joints)? };
        let same = this.arm()?.clone();
        this.start(same, &settings, &joints)
    })())
}

/// The production tool: a rigid transform from the tool frame to the flange
/// frame, 3 rows of 4 (rotation, then translation in m). Also while
/// compensation is on; what is applied goes over to it by max_change a tick.
/// Call it once after the first `truearm_load`: until then the tool is the point
/// that was measured in the calibration. It is kept, whatever is loaded or set,
/// until it is given another one or `truearm_init` begins anew.
///
/// # Safety
/// Every pointer is NULL or as typed; `tool` points to 12 floats.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn truearm_set_tool(arm: *mut Truearm, tool: *const f32) -> TruearmError {
    code((|| {
        // SAFETY: the caller's promise.
        let (this, rows) = unsafe { (handle(arm)?, input(tool.cast::<[[f32; 4]; 3]>())?) };
        let tool = Pose::from_rows(&rows).ok_or(TruearmError::BadTool)?;
        let compensator = this.compensator.as_mut().ok_or(TruearmError::NotLoaded)?;
        compensator.set_tool(&tool);
        Ok(())
    })())
}

/// Switches compensation on (any number but 0) or off from the next tick on;
/// it is faded in and out, by the ticks whose commands are finite.
///
/// # Safety
/// `arm` is NULL or came from `truearm_init`.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn truearm_set_active(arm: *mut Truearm, active: i32) -> TruearmError {
    code((|| {
        // SAFETY: the caller's promise.
        let this = unsafe { handle(arm)? };
        let compensator = this.compensator.as_mut().ok_or(TruearmError::NotLoaded)?;
        compensator.set_active(active != 0);
        Ok(())
    })())
}

/// A panic that can be reached is a link error of the C program.
#[cfg(not(test))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    unsafe extern "C" {
        fn truearm_panic_is_reachable() -> !;
    }
    // SAFETY: never called: the function does not exist, and nothing links
    // that could get here.
    unsafe { truearm_panic_is_reachable() }
}
