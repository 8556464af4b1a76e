//! Two slots in flash or EEPROM of which one always holds good parameters,
//! whenever the power fails.
//!
//! A slot is the bytes of a blob as they are, so that a file of `truearm pack`
//! which a programmer writes to the slot's address is a stored blob. There is
//! no header to commit: the **first write word**, which holds the magic, is
//! written last. The end of a slot is the store's own:
//!
//! | offset | contents | order of writing |
//! |---|---|---|
//! | 0 | first write word of the blob: the commit | 3 |
//! | one word | rest of the blob, padded with 0xff to whole words | 2 |
//! | slot size - 2 k | `BEGN` or `CPY` and a number, last four bytes of the blob | 1 |
//! | slot size - k | `DONE`, last four bytes of the blob | 4 |
//!
//! with k = 8 or the word, whichever is longer.
//!
//! # What it serves
//! [`Store::open`] is given the robot's [`Acceptance`](crate::blob::Acceptance)
//! (its id, its number of joints, perhaps a key) and a buffer. From then on the
//! store takes what a later `open` with the same two would return, and refuses
//! the rest by name. It erases
//!
//! | what a slot holds | `open` | `store`, if the slot is needed |
//! |---|---|---|
//! | an older blob of this robot | only for a copy of the newer one | yes |
//! | a store that was cut, or damaged before it ended | yes | yes |
//! | other bytes, a damaged blob | only for a copy of the newer one | yes |
//! | a whole blob that was refused: longer than the buffer, another robot's, of another number of joints, of another layout or with a part to come, without the key's tag, of the last sequence number | never | never: [`WriteError::Occupied`] |
//! | what could not be read | never | never, until an `open` reads it |
//!
//! Whole is what its checksum says, in whatever layout; only
//! [`Store::discard`] erases it, on purpose.
//!
//! # What `BEGN` and `DONE` are for
//! A program operation that the power cut short can leave cells which read
//! right today and wrong tomorrow. A checksum cannot see that, and neither can
//! reading twice. `DONE` can: it is begun only when the commit word is finished,
//! so where four of its bits are programmed, the commit is solid. `BEGN` is
//! finished before the commit word is begun: a valid blob without `BEGN` was
//! written by a programmer and is solid too. What has `BEGN` and no `DONE` is
//! an unfinished store. [`Store::open`] erases it unless it is whole. Where it
//! is the newest valid blob, it writes that anew from memory: in place where the
//! other slot has an older blob to fall back to or is not the store's to erase,
//! otherwise to the other slot, for what is the only blob may have been in use.
//! A `DONE` with more than
//! two wrong bits may read as none tomorrow, so such a blob, which is solid, is
//! copied to the other slot as well. A copy begins with `CPY` and the number of
//! copies in place of `BEGN`: an unfinished copy is given up for its original,
//! and a solid copy is preferred to its original, which may have been erased in
//! part since. Only when all this is done does `open` return.
//!
//! What `open` returned is final, unless it says [`Settled::Failed`]: from then
//! on there is that blob or one that was stored after it.
//!
//! # When the power fails
//! `n` is the blob in use, in slot A; `n+1` is being stored.
//!
//! | the power fails while | slot A | slot B | the next `open` |
//! |---|---|---|---|
//! | B is erased | n | anything, but no newer blob | returns n |
//! | `BEGN` is written | n | `BEGN` torn | returns n |
//! | the payload is written or read back | n | no magic | erases B, returns n |
//! | the commit word is written | n | torn, reads valid twice | writes B anew, returns n+1 |
//! | the same | n | torn, reads otherwise | erases B, returns n |
//! | `DONE` is written, few bits are wrong | n | n+1 | returns n+1 |
//! | the same, many bits are wrong | n | n+1, solid | copies it to A, returns n+1 |
//! | the same, hardly a bit is programmed | n | n+1, solid | writes B anew, returns n+1 |
//! | the store has returned | n | n+1 | returns n+1 |
//! | `open` writes B anew or erases it | n | as in a store | as above: n+1 or n |
//! | `open` copies B to A | as in a store | n+1, solid | returns n+1, with or without a copy |
//!
//! Without a blob in use, read "nominal" for n; n+1 is then written to A, and
//! what reads valid after a cut is copied to B. Where the other slot is not the
//! store's to erase (F), there is no place for a copy:
//!
//! | the power fails while | slot A | slot B | the next `open` |
//! |---|---|---|---|
//! | the commit word of the first n is written, or hardly a bit of its `DONE` | F | n, reads valid twice | writes B anew, returns n |
//! | the same, reads otherwise | F | torn | erases B, nominal |
//! | `DONE` of the first n is written, many bits are wrong | F | n, solid | returns n as [`Settled::Failed`]: a later one may have to write B anew |
//! | `open` writes B anew | F | as in a store | as above: n or nominal |
//!
//! With an n in use, F leaves no slot for n+1, and `store` writes nothing.
//!
//! What is asked of a memory, and why it can be had:
//!
//! | asked | without it | why it holds |
//! |---|---|---|
//! | a cut word spoils no other word | anything could be lost | that is what a write word, or an EEPROM's page, is; give the larger one if the part's ECC word is larger |
//! | an erase that is cut may leave anything, but does not leave the front of a block whole while its end reads erased | a torn blob could lose its `BEGN` and pass for a programmer's | all cells of a block fade together, and blocks and pages are erased from the front |
//! | a `DONE` that read with two wrong bits or fewer does not read with fewer than four programmed ones later | a blob that was returned could be taken for unfinished, rewritten in place, and a cut then leave the older one | in words of up to four bytes only the last word of `DONE` can be torn, the others are solid; in a longer word some 34 undecided bits would have to fall one way almost all at once, and later all the other way |
//! | a word that a cut left half programmed is read as something, not as an error for ever | later stores end in [`WriteError::Occupied`], nothing is lost: a fault of one word is not told from a memory that does not answer, and what cannot be read is not erased | flash without error correction; [`EccNor`] of one with it, or [`Store::discard`] of that slot, called on purpose |
//! | the cells of both slots take what is written | on a blank device with a worn cell in slot A, [`WriteError::ReadBack`] at every store; beside a blob in use that one stays | parts are replaced before they are worn; a store erases each slot every second time |
//!
//! The newest valid slot is never erased or written by [`Store::store`].
//! Storing what is in use already (time of creation, tag and checksum aside)
//! under the same number or a lower one writes nothing.

mod bytes;
mod ecc;
mod marks;
mod medium;
mod nor;
mod open;
mod report;
mod slot;
mod write;

pub use bytes::ByteSlots;
pub use ecc::EccNor;
pub use medium::{Fault, FaultKind, GeometryError, MAX_WORD, Medium, Operation, Slot};
pub use nor::NorSlots;
pub use report::{
    Opened, Progress, Rejection, Settled, SlotState, Source, StoreError, Stored, WriteError,
};
pub use slot::Store;
