//! Labels of rows, and when two of them are the same.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::table::Table;

/// What the label of every row is compared by; `None` of an empty one.
pub(super) type Keys = Vec<Option<String>>;

/// Ways to compare labels, from the strictest on.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    /// As they stand.
    Written,
    /// Without regard to case, separators and leading zeros: `P-007` is `p7`.
    Spelled,
    /// By the number behind what all labels of a file begin with: `A::P007` is `7`.
    Numbered,
}

/// So large a part of the labels of a file begin alike if they are counted.
const COUNTED: f64 = 0.75;

/// Words and numbers of a label: `A::P007` is a, p, 7.
fn tokens(text: &str) -> Vec<String> {
    let (mut tokens, mut before) = (Vec::<String>::new(), None);
    for c in text.chars().flat_map(char::to_lowercase) {
        let kind = c.is_alphanumeric().then(|| c.is_numeric());
        match (kind, tokens.last_mut()) {
            (None, _) => {}
            (Some(_), Some(token)) if kind == before => token.push(c),
            _ => tokens.push(c.to_string()),
        }
        before = kind;
    }
    for token in tokens.iter_mut().filter(|t| t.bytes().all(|b| b.is_ascii_digit())) {
        *token =
            token[..token.len() - 1].trim_start_matches('0').to_owned() + &token[token.len() - 1..];
    }
    tokens
}

/// Whether the labels of a column are whole numbers.
pub(super) fn whole(table: &Table, column: usize) -> bool {
    let mut filled = (0..table.rows.len()).filter(|row| !table.text(*row, column).is_empty());
    filled.clone().count() > 0
        && filled.all(|row| table.number(row, column).is_some_and(|n| n.fract() == 0.0))
}

/// The labels of a column as tokens; a spreadsheet may write 7 as `7.0`.
fn all_tokens(table: &Table, column: usize) -> Vec<Vec<String>> {
    let whole = whole(table, column);
    let label = |row| match table.number(row, column).filter(|_| whole) {
        Some(number) => vec![format!("{number:.0}")],
        None => tokens(table.text(row, column)),
    };
    (0..table.rows.len()).map(label).collect()
}

/// What counted labels begin with, and what others do.
struct Counted {
    before: Vec<String>,
    others: HashSet<Vec<String>>,
}

/// What stands before the number of a label that ends in one.
fn before_number(tokens: &[String]) -> Option<&[String]> {
    let (last, before) = tokens.split_last()?;
    last.parse::<i64>().is_ok().then_some(before)
}

impl Counted {
    /// `None` where labels do not begin alike: of `T1P1` and `T2P1` nobody knows which
    /// is 1.
    fn of(labels: &[Vec<String>]) -> Option<Self> {
        let distinct: HashSet<&Vec<String>> = labels.iter().filter(|l| !l.is_empty()).collect();
        let mut begun: BTreeMap<&[String], usize> = BTreeMap::new();
        distinct
            .iter()
            .filter_map(|l| before_number(l))
            .for_each(|b| *begun.entry(b).or_default() += 1);
        let (before, count) = begun.iter().max_by_key(|(_, count)| **count)?;
        let others = begun.keys().filter(|b| *b != before).map(|b| b.to_vec()).collect();
        (*count as f64 >= COUNTED * distinct.len() as f64)
            .then(|| Self { before: before.to_vec(), others })
    }
}

/// The keys of a column each in one way; `None` where it does not suit them, above
/// all where it makes two labels of a file one.
fn keys(tables: &[&Table], columns: &[usize], way: Way) -> Option<Vec<Keys>> {
    let both = || tables.iter().zip(columns);
    let tokens: Vec<_> = both().map(|(table, column)| all_tokens(table, *column)).collect();
    let counted = match way {
        Way::Numbered => tokens.iter().map(|t| Counted::of(t)).collect::<Option<Vec<_>>>()?,
        _ => Vec::new(),
    };
    // What begins the labels of one file means something else where others begin so.
    if counted.iter().any(|one| counted.iter().any(|other| other.others.contains(&one.before))) {
        return None;
    }
    let key = |file: usize, row: usize| {
        let (text, tokens) = (tables[file].text(row, columns[file]), &tokens[file][row]);
        let number = || {
            let begins = before_number(tokens)? == counted.get(file)?.before;
            tokens.last().filter(|_| begins).map(|number| format!("#{number}"))
        };
        match way {
            _ if text.is_empty() => None,
            Way::Spelled | Way::Numbered if !tokens.is_empty() => {
                Some(number().unwrap_or_else(|| tokens.join(" ")))
            }
            _ => Some(text.to_owned()),
        }
    };
    let mut all = Vec::new();
    for (file, table) in tables.iter().enumerate() {
        let keys: Keys = (0..table.rows.len()).map(|row| key(file, row)).collect();
        let mut texts = HashMap::new();
        for (row, key) in keys.iter().enumerate() {
            let text = table.text(row, columns[file]);
            if key.as_ref().is_some_and(|key| *texts.entry(key).or_insert(text) != text) {
                return None;
            }
        }
        drop(texts);
        all.push(keys);
    }
    Some(all)
}

/// Columns of which the labels were compared.
pub(super) struct Compared {
    pub keys: Vec<Keys>,
    /// Rows with a partner in every other file, a file.
    found: Vec<usize>,
    /// Whether labels are the same by more than a number.
    pub spelled: bool,
}

impl Compared {
    /// In the strictest of the ways in which most rows find a partner.
    pub fn of(tables: &[&Table], columns: &[usize]) -> Self {
        let compared = |way: Way| {
            let keys = keys(tables, columns, way)?;
            let sets: Vec<HashSet<&String>> =
                keys.iter().map(|keys| keys.iter().flatten().collect()).collect();
            let partner = |key: &&String| sets.iter().all(|set| set.contains(key));
            let found =
                keys.iter().map(|keys| keys.iter().flatten().filter(partner).count()).collect();
            Some(Self { keys, found, spelled: way != Way::Numbered })
        };
        let ways = [Way::Numbered, Way::Spelled, Way::Written].into_iter().filter_map(compared);
        let nothing = Self { keys: Vec::new(), found: Vec::new(), spelled: true };
        // Of several that are equal the last is taken.
        ways.max_by_key(|c| c.found.iter().sum::<usize>()).unwrap_or(nothing)
    }

    fn repeats(&self) -> usize {
        self.keys.iter().filter(|keys| !unique(keys)).count()
    }

    /// Whether at least half the rows of every file find a partner in all others, and
    /// at most one file repeats a label.
    pub fn fit(&self) -> bool {
        let mut files = self.keys.iter().zip(&self.found);
        self.repeats() <= 1 && files.all(|(keys, found)| 2 * found >= keys.len())
    }

    /// Whether every row has one partner.
    pub fn one_to_one(&self) -> bool {
        let mut files = self.keys.iter().zip(&self.found);
        self.repeats() == 0 && files.all(|(keys, found)| *found == keys.len())
    }
}

/// Whether no label stands there twice.
fn unique(keys: &Keys) -> bool {
    let all = keys.iter().flatten();
    all.clone().collect::<HashSet<_>>().len() == all.count()
}

/// Whether nearly every row of a column has a label of its own.
pub(super) fn distinct(table: &Table, column: usize) -> bool {
    let texts = (0..table.rows.len()).map(|row| table.text(row, column));
    let labels: HashSet<&str> = texts.filter(|text| !text.is_empty()).collect();
    labels.len() > 2 && labels.len() as f64 >= 0.9 * table.rows.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_as_words_and_numbers() {
        for (text, expected) in [
            ("A::P007", "a p 7"),
            ("P-7", "p 7"),
            ("P5_2", "p 5 2"),
            ("T1P10", "t 1 p 10"),
            ("000", "0"),
            ("Größe 3", "größe 3"),
            ("**", ""),
            ("", ""),
        ] {
            assert_eq!(tokens(text).join(" "), expected, "{text}");
        }
    }
}
