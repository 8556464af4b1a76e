//! Columns that say which rows of several files belong together.

use super::clock::seconds;
use super::labels::{Compared, distinct, whole};
use super::table::Table;
use crate::error::{Error, Place, Result};
use crate::headings::{Heading, Named, Role};

/// A column a file, and what says so.
pub(super) struct Key {
    pub columns: Vec<usize>,
    pub because: String,
    /// Whether it may be a mere count of the rows.
    pub count: bool,
}

/// How likely a column each of two files is a key, the larger the likelier: labels
/// that are spelled alike before numbers, whatever the headings; then headings.
type Likely = (bool, bool);

/// The columns that hold the same labels; `None` without any.
pub(super) fn find(tables: &[Table]) -> Option<Key> {
    // What a column is, is asked once and not of each pair.
    let all: Vec<Vec<Column>> = tables.iter().map(Column::all).collect();
    let (first, others) = all.split_first()?;
    let mut best: Option<(Likely, Vec<usize>)> = None;
    for column in first {
        let partner = |other: &Vec<Column>| {
            let of = |c: &Column| likely([column, c]).map(|likely| (likely, c.index));
            other.iter().filter_map(of).rev().max_by_key(|(likely, _)| *likely)
        };
        let Some(partners) = others.iter().map(partner).collect::<Option<Vec<_>>>() else {
            continue;
        };
        let least = partners.iter().map(|(likely, _)| *likely).min()?;
        let columns: Vec<usize> =
            std::iter::once(column.index).chain(partners.iter().map(|(_, c)| *c)).collect();
        let better = best.as_ref().is_none_or(|(known, _)| least > *known);
        if better && Compared::of(&tables.iter().collect::<Vec<_>>(), &columns).fit() {
            best = Some((least, columns));
        }
    }
    best.map(|(likely, columns)| {
        let names: Vec<String> = columns.iter().zip(tables).map(|(c, t)| t.called(*c)).collect();
        let because = format!("{} hold the same labels", names.join(" and "));
        let numbers = columns.iter().zip(tables).all(|(c, t)| t.numeric(*c));
        Key { columns, because, count: numbers && likely == (false, false) }
    })
}

/// A column that may be a key.
struct Column<'t> {
    table: &'t Table,
    index: usize,
    /// Whether its heading sounds like one.
    keyed: bool,
    /// Whether it is no column of numbers.
    texts: bool,
    /// Whether its cells may be labels, whatever the heading.
    labels: bool,
}

impl<'t> Column<'t> {
    fn all(table: &'t Table) -> Vec<Self> {
        let of = |index: usize| {
            let texts = !table.numeric(index);
            let labels = texts || whole(table, index) && counts(table, index);
            Self { table, index, keyed: keyed(&table.headings[index]), texts, labels }
        };
        (0..table.headings.len()).map(of).collect()
    }

    fn heading(&self) -> &str {
        &self.table.headings[self.index].text
    }
}

/// `None` of columns that are no key.
fn likely([a, b]: [&Column; 2]) -> Option<Likely> {
    let same = !a.heading().is_empty() && a.heading().eq_ignore_ascii_case(b.heading());
    let alike = same || a.keyed && b.keyed;
    if !(alike || a.labels && b.labels) {
        return None;
    }
    let compared = Compared::of(&[a.table, b.table], &[a.index, b.index]);
    let spelled = a.texts && b.texts && compared.spelled && compared.fit();
    (spelled || alike && compared.fit() || compared.one_to_one()).then_some((spelled, alike))
}

/// Whether a heading sounds like a key.
fn keyed(heading: &Heading) -> bool {
    let words = ["id", "point", "name", "pose", "punkt", "label", "key", "poseid", "pointid"];
    heading.words.last().is_some_and(|w| words.contains(&w.as_str()))
        || Named::of(heading).is_some_and(|n| n.role == Role::Order)
}

/// Whether whole numbers under a heading may be labels: they are no coordinate.
fn counts(table: &Table, column: usize) -> bool {
    let heading = &table.headings[column];
    let named = Named::of(heading);
    heading.unit.is_none() && named.is_none_or(|n| n.role == Role::Order) && distinct(table, column)
}

/// That files are put together by position although both have labels; `None` where one
/// has none.
pub(super) fn ignored_labels(tables: &[Table]) -> Option<String> {
    let mut names = Vec::new();
    for table in tables {
        let texts = |column: &usize| {
            let time = seconds(table.text(0, *column)).is_some();
            !table.numeric(*column) && !time && distinct(table, *column)
        };
        let labels = |column: &usize| keyed(&table.headings[*column]) && distinct(table, *column);
        let mut columns = 0..table.headings.len();
        let column = columns.clone().find(texts).or_else(|| columns.find(labels))?;
        names.push(format!(
            "{}, {} (\"{}\", \"{}\", ...)",
            table.path.display(),
            table.called(column),
            table.text(0, column),
            table.text(1, column)
        ));
    }
    Some(format!(
        "rows are put together by their position or number although all files have labels, which are not the \
         same: {}; if that is wrong, mend the labels or name a column that says which rows belong \
         together: --join COLUMN, or --join ONE=OTHER where headings differ",
        names.join("; ")
    ))
}

/// The columns of `--join COLUMN`, or of `--join ONE=OTHER` where headings differ.
///
/// # Errors
/// A file without such a column.
pub(super) fn named(tables: &[Table], asked: &str) -> Result<Vec<usize>> {
    let column = |table: &Table, name: &str| {
        table.headings.iter().position(|h| h.text.eq_ignore_ascii_case(name.trim()))
    };
    let find = |(file, table): (usize, &Table)| {
        let names: Vec<&str> = asked.split('=').collect();
        let own = names.get(file).filter(|_| names.len() == tables.len());
        let found = column(table, asked).or_else(|| own.and_then(|name| column(table, name)));
        let found = found.or_else(|| names.iter().find_map(|name| column(table, name)));
        found.ok_or_else(|| {
            let help = format!("it has {}; --join ONE=OTHER where headings differ", table.list());
            Error::file(&table.path, Place::default(), format!("no column {asked}"), help)
        })
    };
    tables.iter().enumerate().map(find).collect()
}
