use super::marks::Mark;
use super::medium::{Medium, Slot};
use super::report::{StoreError, Stored, WriteError};
use super::slot::{Held, Store};

impl<M: Medium> Store<M> {
    /// Stores a blob in the slot that is not in use: erases it, writes the
    /// payload, reads it back, commits. While nothing is in use and the first
    /// slot fails, in the other one.
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
        let sequence = blob.sequence();
        let bytes = bytes.get(..blob.size()).unwrap_or(bytes);
        if let Some((slot, stored)) = self.live
            && sequence <= stored
        {
            let content = blob.content();
            return if self.compare(slot, bytes, &content).map_err(WriteError::Fault)? {
                Ok(Stored::Unchanged { sequence: stored })
            } else {
                Err(StoreError::NotNewer { stored, offered: sequence })
            };
        }
        let target = match self.live {
            Some((slot, _)) => slot.other(),
            None if Slot::A.of(self.held) == Held::Free => Slot::A,
            None => Slot::B,
        };
        let slot = self.write_either(target, bytes)?;
        self.live = Some((slot, sequence));
        Ok(Stored::Written(slot))
    }

    /// Writes a blob to a slot, or to the other one if that fails and nothing
    /// could be lost; where it went.
    fn write_either(&mut self, slot: Slot, bytes: &[u8]) -> Result<Slot, WriteError<M::Error>> {
        let other = slot.other();
        let Err(error) = self.write(slot, Mark::Begun { copies: 0 }, bytes) else {
            return Ok(slot);
        };
        if self.live.is_some() {
            return Err(error);
        }
        // What the first slot took may yet be whole: the other is its copy.
        match self.write(other, Mark::Begun { copies: 1 }, bytes) {
            Ok(()) => Ok(other),
            // Nothing was written there: what went wrong before counts.
            Err(WriteError::Occupied(_)) => Err(error),
            Err(error) => Err(error),
        }
    }

    /// Erases a slot that is not in use, whatever it holds: another robot's
    /// blob, one of a newer layout, one that was longer than the buffer, what a
    /// device that answers does not read. The store never does so by itself,
    /// but for the last where it is surely torn (see the [module](super)).
    /// Where it was [`Settled::Failed`] for that slot, open it again then.
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
        slot.replace(&mut self.held, Held::Free);
        Ok(())
    }
}
