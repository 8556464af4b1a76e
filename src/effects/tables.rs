/// Bytes of a table.
const SIZE: usize = 512;

/// Tables of an arm's effects, of 512 bytes each, borrowed from the blob that
/// carries them: what does not fit into a [`super::Term`] stays in the slot and
/// is not copied.
///
/// Format 1.0 has no effect with a table, so that every arm's run is empty
/// today.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Tables<'t> {
    tables: &'t [[u8; SIZE]],
}

impl<'t> Tables<'t> {
    /// No tables.
    pub const NONE: Self = Self { tables: &[] };

    /// A run of whole tables; `None` where the last one is cut off.
    #[must_use]
    pub const fn of(bytes: &'t [u8]) -> Option<Self> {
        match bytes.as_chunks() {
            (tables, []) => Some(Self { tables }),
            _ => None,
        }
    }

    /// How many there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.tables.len()
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.tables.is_empty()
    }

    /// The `index`-th table, counted from 0.
    #[must_use]
    pub fn get(&self, index: usize) -> Option<&'t [u8; SIZE]> {
        self.tables.get(index)
    }
}

#[cfg(test)]
mod tests {
    use super::Tables;

    #[test]
    fn only_whole_tables_are_taken() {
        let bytes: [u8; 1024] = core::array::from_fn(|i| (i / 512) as u8);
        let two = Tables::of(&bytes).expect("whole tables");
        assert_eq!((two.len(), two.is_empty()), (2, false));
        assert_eq!((two.get(1), two.get(2)), (Some(&[1; 512]), None));
        assert_eq!(Tables::of(&bytes[..1023]), None);
        assert_eq!(Tables::of(&[]), Some(Tables::NONE));
    }
}
