//! What the fuzz targets do with their bytes.

#[cfg(feature = "readers")]
mod readers;
#[path = "../../tests/store/rig/mod.rs"]
mod rig;

use std::sync::LazyLock;

use truearm::blob::{Blob, EncodeError, encode};
use truearm::compensate::{Compensator, Settings, Task};
use truearm::{Arm, ArmParameters, State};

#[cfg(feature = "readers")]
pub use readers::readers;
use rig::cells::{Cut, EccPart, EepromPart, NorPart, Part, Tear};
use rig::cuts::{Bench, Blobs, Start};
use rig::samples;

/// Bytes that claim to be a blob: as they are, and with the checksum they need
/// for the checks behind it to be reached.
pub fn decode(data: &[u8]) {
    check(data);
    let mut sealed = data.to_vec();
    let length = data.get(8..12).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    if let Some(blob) = sealed.get_mut(..length.unwrap_or(0)).filter(|blob| blob.len() >= 4) {
        samples::seal(blob);
        check(&sealed);
    }
}

fn check(bytes: &[u8]) {
    let Ok(blob) = Blob::check(bytes) else { return };
    assert_eq!(Blob::check(&bytes[..blob.size()]), Ok(blob), "bytes behind the blob count");
    assert!(Blob::check(&bytes[..blob.size() - 1]).is_err(), "its last byte does not count");
    match blob.joints() {
        1 => use_as::<1>(&blob),
        2 => use_as::<2>(&blob),
        3 => use_as::<3>(&blob),
        4 => use_as::<4>(&blob),
        5 => use_as::<5>(&blob),
        6 => use_as::<6>(&blob),
        7 => use_as::<7>(&blob),
        16 => use_as::<16>(&blob),
        _ => assert!(blob.parameters::<f32, 6>().is_err(), "for another number of joints"),
    }
}

fn use_as<const N: usize>(blob: &Blob) {
    let parameters: ArmParameters<f32, N> = blob.parameters().expect("an arm of these joints");
    // Whatever an arm of these numbers does, what a tick commands are numbers.
    let (settings, at) = (Settings::new(Task::Position), [0.5; N]);
    if let Ok(mut compensator) = Compensator::new(Arm::new(&parameters), settings, &at) {
        compensator.set_active(true);
        for _ in 0..3 {
            let tick = compensator.tick(&at, &State::at(20.0));
            assert!(tick.joints.iter().all(|joint| joint.is_finite()), "{tick:?}");
        }
    }
    let mut bytes = vec![0; blob.size()];
    let written = encode(&parameters, &mut bytes);
    if parameters.sequence == u32::MAX {
        assert_eq!(written, Err(EncodeError::LastSequence));
        return;
    }
    let size = written.expect("what was read can be written");
    let again = Blob::check(&bytes[..size]).and_then(|blob| blob.parameters::<f32, N>());
    assert_eq!(again.as_ref(), Ok(&parameters));
}

/// A history of power-ups and stores with power cuts: the first bytes say on
/// which part and from which start, every four more are one power-up. Or a
/// memory with damage.
pub fn store(data: &[u8]) {
    let Some(([bench, seed], rest)) = data.split_first_chunk() else { return };
    BENCHES[usize::from(*bench) % BENCHES.len()].try_out(*seed, rest);
}

/// Of every part from every start; building them takes longer than using them.
static BENCHES: LazyLock<Vec<Box<dyn TryOut>>> = LazyLock::new(|| {
    let benches = [
        from_all_starts::<NorPart<1, 64>>(),
        from_all_starts::<NorPart<4, 128>>(),
        from_all_starts::<NorPart<8, 512>>(),
        from_all_starts::<NorPart<32, 256>>(),
        from_all_starts::<EepromPart<8>>(),
        from_all_starts::<EepromPart<32>>(),
        from_all_starts::<EccPart<8, 512>>(),
    ];
    benches.into_iter().flatten().collect()
});

fn from_all_starts<P: Part + Send + Sync + 'static>() -> [Box<dyn TryOut>; Start::ALL.len()] {
    Start::ALL.map(|start| -> Box<dyn TryOut> {
        Box::new(Bench::<P>::new(start, Blobs::small(LONGEST + 4)))
    })
}

/// Most power-ups of a history.
const LONGEST: u32 = 12;

trait TryOut: Send + Sync {
    fn try_out(&self, seed: u8, data: &[u8]);
}

impl<P: Part + Send + Sync> TryOut for Bench<P> {
    fn try_out(&self, seed: u8, data: &[u8]) {
        if seed & 1 == 1 {
            let Some(([low, high], damage)) = data.split_first_chunk() else { return };
            return self.damaged(usize::from(u16::from_le_bytes([*low, *high])), damage);
        }
        let mut history = self.history(u64::from(seed));
        for [low, high, tear, what] in data.as_chunks().0.iter().take(LONGEST as usize) {
            let at = usize::from(u16::from_le_bytes([*low, *high])) % 512;
            let tear = Tear::ALL[usize::from(*tear) % Tear::ALL.len()];
            history.power_up((what & 1 == 0).then_some(Cut { at, tear }), what & 2 == 0);
        }
        history.power_up(None, true);
        history.power_up(None, false);
    }
}
