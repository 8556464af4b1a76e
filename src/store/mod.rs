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
//! | slot size - 2 k | `BEGN`, last four bytes of the blob | 1 |
//! | slot size - k | `DONE`, last four bytes of the blob | 4 |
//!
//! with k = 8 or the word, whichever is longer.
//!
//! # What `BEGN` and `DONE` are for
//! A program operation that the power cut short can leave cells which read
//! right today and wrong tomorrow. A checksum cannot see that, and neither can
//! reading twice. `DONE` can: it is begun only when the commit word is finished,
//! so where a few of its bits are programmed, the commit is solid. `BEGN` is
//! finished before the commit word is begun: a valid blob without `BEGN` was
//! written by a programmer and is solid too. What has `BEGN` and nothing of
//! `DONE` is an unfinished store. [`Store::open`] finishes it if it reads as a
//! valid blob and is the newest, by writing it anew from memory, and erases it
//! otherwise; only then does it return.
//!
//! What `open` returned is final: from then on there is that blob or one that
//! was stored after it. Everything else is left as it is: blobs of another
//! robot or of a newer layout, damaged ones, and whatever a programmer wrote.
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
//! | `DONE` is written | n | n+1, `DONE` torn | returns n+1; below four programmed bits it writes B anew first |
//! | the store has returned | n | n+1 | returns n+1 |
//! | `open` writes B anew or erases it | n | as in a store | as above: n+1 or n |
//!
//! Without a blob in use, read "nominal" for n. Two things are asked of a
//! memory. An erase that is cut may leave anything, except that the front of a
//! block stays whole while its end reads erased. A word that is cut may leave
//! any bits, also such as read differently from time to time, but a `DONE` that
//! reads with four programmed bits or more does not read with fewer later.
//!
//! The newest valid slot is never erased or written by [`Store::store`].
//! Storing what is stored already (sequence, time of creation, tag and
//! checksum aside) writes nothing.

mod bytes;
mod medium;
mod nor;
mod open;
mod report;
mod write;

pub use bytes::ByteSlots;
pub use medium::{Fault, FaultKind, GeometryError, MAX_WORD, Medium, Operation, Slot};
pub use nor::NorSlots;
pub use open::Store;
pub use report::{Opened, Rejection, Settled, SlotState, Source, StoreError, Stored, WriteError};
