//! The 8 bytes of a term.

use super::error::{DecodeError, FieldName, Flaw, Record};
use super::layout::{FLAG_MASSES, FLAG_TORQUES, TERM};
use super::reader::Reader;
use crate::effects::{ActsOn, Effect, FINE, Order, Term};
use crate::scalar::Scalar;

/// Bits 0 to 3 of an effect's code, and where bits 4 and 5 of it stand, which no
/// effect has set so far.
const EFFECT: u8 = 0x0f;
const EFFECT_HIGH: u8 = 0xc0;
const COMPONENT: u8 = 0x10;
const ALL_LINKS: u8 = 0x20;
/// Of a friction, which has no components: its order is in steps of [`FINE`].
const FINE_STEPS: u8 = COMPONENT;
/// Fine steps that are a whole coarse one, as a power of two less one.
const COARSE: u16 = 63;

type Result<T> = core::result::Result<T, DecodeError>;

fn flaw(index: u8, field: &'static str, flaw: Flaw) -> DecodeError {
    DecodeError::Field(FieldName { record: Record::Term(index), group: field, member: "" }, flaw)
}

/// Bytes of a term, the `index`-th counted from 0. Fields that its effect does
/// not use become 0; one that its bits cannot hold is refused.
pub(super) fn to_bytes<T: Scalar>(index: u8, term: &Term<T>) -> Result<[u8; TERM]> {
    let refuse = |field| flaw(index, field, Flaw::Implausible);
    let effect = term.effect;
    let code = effect.code();
    let mut first = code & EFFECT | code << 2 & EFFECT_HIGH;
    let all = term.of_all_links();
    if all {
        first |= ALL_LINKS;
    }
    if effect.has_components() {
        match term.component {
            0 => (),
            1 => first |= COMPONENT,
            _ => return Err(refuse("component")),
        }
    }
    let nibble = |used: bool, joint: u8, field| match joint {
        _ if !used => Ok(0),
        0..16 => Ok(joint),
        _ => Err(refuse(field)),
    };
    let joint = nibble(term.own_joint().is_some(), term.joint, "joint")?;
    let source = nibble(effect.is_coupled(), term.source, "source joint")?;
    let mut order = 0;
    if effect.order() != Order::None {
        let value = term.order.to_f64();
        let step = effect.order().step(value);
        let steps = value / step + 0.5;
        // Few enough steps; and none at all for 0 only, which with a friction
        // torque would mean that gravity never decides. NaN fails, too.
        if !(value == 0.0 || value > 0.0 && (1.0..65536.0).contains(&steps)) {
            return Err(refuse("order"));
        }
        order = steps as u16;
        if step == FINE {
            match order & COARSE {
                0 => order /= COARSE + 1,
                _ => first |= FINE_STEPS,
            }
        }
    }
    let [o0, o1] = order.to_le_bytes();
    let [c0, c1, c2, c3] = (term.coefficient.to_f64() as f32).to_le_bytes();
    Ok([first, joint | source << 4, o0, o1, c0, c1, c2, c3])
}

/// The term in 8 bytes; `None` if there is no such effect. Fields are as they
/// stand there, [`check`] has judged them.
pub(super) fn from_bytes<T: Scalar>(bytes: &[u8; TERM]) -> Option<Term<T>> {
    let [first, joints, o0, o1, c0, c1, c2, c3] = *bytes;
    let code = first & EFFECT | (first & EFFECT_HIGH) >> 2;
    let effect = *Effect::ALL.get(usize::from(code))?;
    let fine = first & FINE_STEPS != 0 && effect.order() == Order::Friction;
    let step = if fine { FINE } else { effect.order().step(f64::INFINITY) } as f32;
    Some(Term {
        effect,
        joint: if first & ALL_LINKS != 0 { Term::<T>::ALL } else { joints & 0x0f },
        source: joints >> 4,
        component: u8::from(first & COMPONENT != 0 && !fine),
        order: T::from_f32(f32::from(u16::from_le_bytes([o0, o1])) * step),
        coefficient: T::from_f32(f32::from_le_bytes([c0, c1, c2, c3])),
    })
}

/// Checks the `index`-th term, counted from 0, of an arm with so many joints. `late` is the
/// time constant of the terms before it: all have one, as a state holds one temperature.
/// `flags` are the blob's: they say what tells of loads. Whether it follows a torque.
pub(super) fn check(
    index: u8,
    bytes: &[u8; TERM],
    (joints, flags): (u8, u8),
    late: &mut Option<f32>,
) -> Result<bool> {
    let unknown = |field| Err(flaw(index, field, Flaw::Unknown));
    let implausible = |field| Err(flaw(index, field, Flaw::Implausible));
    let [first, numbers, low, ..] = *bytes;
    let Some(term) = from_bytes::<f32>(bytes) else { return unknown("effect") };
    let all = first & ALL_LINKS != 0;
    if all && term.effect.acts_on() != ActsOn::Lengths {
        return unknown("flags");
    }
    if term.component != 0 && !term.effect.has_components() {
        return unknown("component");
    }
    let joint = numbers & 0x0f;
    if if term.own_joint().is_some() { joint >= joints } else { joint != 0 } {
        return implausible("joint");
    }
    let source = term.source;
    if if term.effect.is_coupled() { source >= joints || source == joint } else { source != 0 } {
        return implausible("source joint");
    }
    let order = term.effect.order();
    let other = order == Order::TimeConstant && *late.get_or_insert(term.order) != term.order;
    // One number has one form.
    let fine = order == Order::Friction && first & FINE_STEPS != 0;
    if other || !order.takes(term.order) || fine && u16::from(low) & COARSE == 0 {
        return implausible("order");
    }
    if !term.coefficient.is_finite() {
        return Err(flaw(index, "coefficient", Flaw::NotFinite));
    }
    if Scalar::abs(term.coefficient) > term.effect.plausible() {
        return implausible("coefficient");
    }
    let (load, masses) = (term.needs_load(), term.needs_masses());
    let enough = if masses { FLAG_MASSES } else { FLAG_MASSES | FLAG_TORQUES };
    if load && flags & enough == 0 {
        return Err(flaw(index, "effect", Flaw::NeedsMasses));
    }
    Ok(load && !masses)
}

/// Reads the terms behind the joint records.
pub(super) fn each(bytes: &[u8]) -> impl Iterator<Item = &[u8; TERM]> {
    let mut reader = Reader(bytes);
    core::iter::from_fn(move || reader.take())
}
