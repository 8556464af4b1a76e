//! What a refusal of a blob means to the one who has to do something about it.

use truearm::blob::{AcceptanceError, DecodeError, Flaw, MAGIC, Record};

/// What a refusal means and what to do about it.
#[must_use]
pub fn explain(bytes: &[u8], refusal: &AcceptanceError) -> String {
    let text = match refusal {
        AcceptanceError::Damaged(error) => return explain_damage(bytes, error),
        AcceptanceError::WrongRobot { .. } => {
            "these are another robot's parameters: its geometry, not this one's. The id is a hash of name and \
             serial of robot.toml; check both, and which robot the tracker measured"
        }
        AcceptanceError::WrongJoints { .. } => {
            "these are the parameters of an arm of another kind that was given this one's name and serial; \
             check both in robot.toml"
        }
        AcceptanceError::LastSequence => "pack again with a lower --sequence",
        AcceptanceError::OldSequence { .. } => {
            "the controller has newer parameters; to go back on purpose, pack again with a higher --sequence"
        }
        AcceptanceError::NoTag => "a controller with a key refuses it; pack with --key",
        AcceptanceError::WrongKey => {
            "it was packed with another key, or changed by someone who does not have the key"
        }
        _ => "",
    };
    text.to_owned()
}

fn explain_damage(bytes: &[u8], error: &DecodeError) -> String {
    let text = match error {
        DecodeError::Truncated { .. } if bytes.is_empty() => "the file is empty",
        _ if !bytes.starts_with(&MAGIC) => match bytes {
            [b':', ..] => "it looks like Intel HEX; give the file of --format bin",
            [b'U', b'F', b'2', b'\n', ..] => "it looks like UF2; give the file of --format bin",
            [0x7f, b'E', b'L', b'F', ..] => {
                "it looks like ELF; objcopy -O binary makes a blob of it"
            }
            [0xff, 0xff, 0xff, 0xff, ..] => "it is erased flash: nothing was written there",
            _ => {
                "give a file written by `truearm pack`, or a memory dump that begins with the slot"
            }
        },
        DecodeError::Truncated { .. } => {
            "the end is missing: an interrupted write or copy. Copy or pack it again"
        }
        DecodeError::DraftLayout(_) => "it is older than format 1.0; pack the model again",
        DecodeError::NewerLayout(_) => {
            "a newer truearm wrote it: update this program and the firmware, or pack with the older one"
        }
        DecodeError::Checksum { .. } => {
            "bytes changed after it was packed: a worn cell, a bad transfer, an edit. Pack the model again"
        }
        DecodeError::JointCount(_) | DecodeError::TermCount(_) | DecodeError::Length { .. } => {
            "the header contradicts itself: damaged, or not written by truearm. Pack the model again"
        }
        DecodeError::Field(name, flaw)
            if matches!(name.record, Record::Curve(_)) && *flaw != Flaw::Unknown =>
        {
            "the checksum is right, so it was written so. A curve is of a joint that turns, one a joint in their \
             order, with 32 to 512 nodes of at most 0.05 rad"
        }
        DecodeError::Field(_, flaw) => match flaw {
            Flaw::NeedsMasses => "give gravity_m_s2 and [[links]] in robot.toml and identify again",
            Flaw::Unknown => {
                "a newer truearm wrote it, or a faulty writer did: the checksum is right"
            }
            _ => {
                "the checksum is right, so it was written so. src/blob/FORMAT.md has the range of every field; \
                 corrections beyond theirs point to a wrong nominal geometry or a wrong unit"
            }
        },
        _ => "pack the model again",
    };
    text.to_owned()
}
