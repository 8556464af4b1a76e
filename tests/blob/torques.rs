//! Blobs of arms whose terms follow torques that are read.

use truearm::blob::{Blob, encode};
use truearm::effects::{Effect, NeedsLoad};
use truearm::{Arm, ArmParameters};

use crate::blobs::{mend, parameters};

/// Bit 5 of the flags, bit 1: masses.
const FLAGS: usize = 28;
const TORQUES: u8 = 1 << 5;
const MASSES: u8 = 1 << 1;

fn encoded(p: &ArmParameters<'_, f32, 3>) -> Result<Vec<u8>, String> {
    let mut bytes = vec![0; 4096];
    let size = encode(p, &mut bytes).map_err(|e| e.to_string())?;
    bytes.truncate(size);
    Ok(bytes)
}

fn refused(mut bytes: Vec<u8>, flags: impl Fn(u8) -> u8) -> String {
    bytes[FLAGS] = flags(bytes[FLAGS]);
    mend(&mut bytes);
    Blob::check(&bytes).unwrap_err().to_string()
}

/// Without the terms that masses alone can tell.
fn of_torques() -> ArmParameters<'static, f32, 3> {
    let all = parameters();
    let terms = all.terms.iter().filter(|term| !term.needs_masses()).copied().collect();
    ArmParameters { terms, ..all }
}

/// So firmware that knows of no torques refuses it.
#[test]
fn a_blob_says_that_torques_are_read() {
    let p = ArmParameters { masses: None, ..of_torques() };
    let bytes = encoded(&p).unwrap();
    let blob = Blob::check(&bytes).unwrap();
    assert_eq!((bytes[FLAGS] & (MASSES | TORQUES), blob.reads_torques()), (TORQUES, true));
    let read: ArmParameters<f32, 3> = blob.parameters().unwrap();
    assert_eq!(read, p);
    assert!(Arm::new(&read).reads_torques());
    assert_eq!(
        refused(bytes, |flags| flags & !TORQUES),
        "term 1 effect needs link masses and gravity, which are not given"
    );
}

/// With masses, or without anything that is loaded, the bytes are those of format 1.4, and a
/// flag too many is refused.
#[test]
fn torques_are_read_only_where_a_term_needs_them() {
    let unloaded = |term: &&truearm::effects::Term<f32>| !term.needs_load();
    let terms = parameters().terms.iter().filter(unloaded).copied().collect();
    for p in [of_torques(), ArmParameters { masses: None, terms, ..parameters() }] {
        let bytes = encoded(&p).unwrap();
        assert_eq!(bytes[FLAGS] & TORQUES, 0);
        assert!(!Blob::check(&bytes).unwrap().reads_torques());
        assert!(!Arm::new(&p).reads_torques());
        let message = refused(bytes, |flags| flags | TORQUES);
        assert_eq!(message, "flags is outside its plausible range");
    }
}

/// No sensor of a joint reads what tilts the base or an axis.
#[test]
fn moments_need_masses() {
    let mut seen = 0;
    for effect in Effect::ALL.iter().filter(|effect| effect.load() == NeedsLoad::Moments) {
        let terms = heapless::Vec::from_iter([crate::blobs::term(*effect, 0, 0.0, 1e-6)]);
        let p = ArmParameters { terms, masses: None, ..parameters() };
        let message = encoded(&p).unwrap_err();
        assert!(message.ends_with("effect needs link masses and gravity, which are not given"));
        seen += 1;
    }
    assert_eq!(seen, 2);
}
