use super::marks::Mark;
use super::medium::{Fault, Medium, Slot};
use super::report::{StoreError, Stored, WriteError};
use super::slot::Store;
use crate::blob::Blob;

impl<M: Medium> Store<M> {
    /// Stores a blob in the slot that is not in use: erases it, writes the
    /// payload, reads it back, commits.
    ///
    /// A blob with a higher number than that in use is written even where the
    /// parameters are the same: after an `Ok` the blob in use has at least the
    /// number that was offered, so that a counter for
    /// [`Acceptance::not_before`](crate::blob::Acceptance::not_before) may
    /// follow either. What it must never be ahead of is [`Store::live`].
    ///
    /// # Errors
    /// When the blob is invalid, not accepted, not newer or too long, or the
    /// slot holds what is not the store's to erase, nothing has been written.
    /// See [`StoreError`].
    pub fn store(&mut self, bytes: &[u8]) -> Result<Stored, StoreError<M::Error>> {
        let blob = self.accept.check(bytes)?;
        if !self.settled {
            return Err(StoreError::Unsettled);
        }
        let offered = blob.sequence();
        if let Some((slot, stored)) = self.live
            && offered <= stored
        {
            let same = self.holds(slot, bytes, &blob).map_err(WriteError::Fault)?;
            return match same {
                true => Ok(Stored::Unchanged { sequence: stored }),
                false => Err(StoreError::NotNewer { stored, offered }),
            };
        }
        let target = match self.live {
            Some((slot, _)) => slot.other(),
            None if Slot::A.of(self.occupied) => Slot::B,
            None => Slot::A,
        };
        let bytes = bytes.get(..blob.size()).unwrap_or(bytes);
        self.write(target, Mark::Begun { copies: 0 }, bytes)?;
        self.live = Some((target, offered));
        Ok(Stored::Written(target))
    }

    /// Erases a slot that is not in use, whatever it holds: another robot's
    /// blob, one of a newer layout, one that was longer than the buffer. The
    /// store never does so by itself. Where it was [`Settled::Failed`] for that
    /// slot, open it again then.
    ///
    /// [`Settled::Failed`]: super::Settled::Failed
    ///
    /// # Errors
    /// [`StoreError::InUse`], and faults of the memory.
    pub fn discard(&mut self, slot: Slot) -> Result<(), StoreError<M::Error>> {
        if self.live.is_some_and(|(live, _)| live == slot) {
            return Err(StoreError::InUse(slot));
        }
        self.medium.erase(slot).map_err(WriteError::Fault)?;
        slot.replace(&mut self.occupied, false);
        Ok(())
    }

    /// Whether a slot has the contents of this blob.
    fn holds(&mut self, slot: Slot, bytes: &[u8], blob: &Blob) -> Result<bool, Fault<M::Error>> {
        let bytes = bytes.get(..blob.size()).unwrap_or(bytes);
        self.compare(slot, bytes, &blob.content())
    }
}
