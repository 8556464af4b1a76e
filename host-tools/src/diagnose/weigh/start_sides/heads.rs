//! Rows before a joint's first move since the order of the rows was lost.

use crate::model::Measurements;

/// Of more heads no side is looked for, and their rows count as in the middle of the gap: each is
/// one of many then. To weigh everything again with 200 of them, of 693 stretches in 1,500 rows of a
/// UR10, took twice the time and moved no name.
const MOST: usize = 200;
/// Most joints of a stretch of which all sides are tried together.
pub const TOGETHER: usize = 10;

/// Rows of a stretch of the order before a joint first moved in it: they have one side.
#[derive(Debug, Clone, PartialEq)]
pub struct Head {
    /// Counted from 0.
    pub joint: usize,
    /// Which stretch.
    pub stretch: usize,
    /// In the order of measurement.
    pub rows: Vec<usize>,
}

/// All of them where sides are those of the order of the rows, of joints that move at all.
pub fn heads(data: &Measurements) -> Vec<Head> {
    if !data.directions_from_order {
        return Vec::new();
    }
    let side = |row: usize, joint: usize| data.rows[row].directions.get(joint).copied();
    let side = |row: usize, joint: usize| side(row, joint).unwrap_or(0);
    let (before, order) = (data.before(), data.in_order());
    let joints = data.rows.first().map_or(0, |row| row.q.len());
    let moves = |joint: &usize| order.iter().any(|row| side(*row, *joint) != 0);
    let moving: Vec<usize> = (0..joints).filter(moves).take(TOGETHER).collect();
    let mut out = Vec::new();
    for (stretch, rows) in order.chunk_by(|_, next| before[*next].is_some()).enumerate() {
        for joint in moving.iter().copied() {
            let waited = rows.iter().copied().take_while(|row| side(*row, joint) == 0);
            out.push(Head { joint, stretch, rows: waited.collect() });
        }
    }
    out.retain(|head| !head.rows.is_empty());
    if out.len() > MOST { Vec::new() } else { out }
}

/// The measurements with these sides of heads, 0 where none is told.
pub fn with(data: &Measurements, heads: &[Head], sides: &[i8]) -> Measurements {
    let mut out = data.clone();
    let joints = data.rows.first().map_or(0, |row| row.q.len());
    out.sides_found = vec![0; joints];
    for (head, side) in heads.iter().zip(sides).filter(|(_, side)| **side != 0) {
        out.sides_found[head.joint] += 1;
        for row in &head.rows {
            let own = &mut out.rows[*row].directions;
            own.resize(joints, 0);
            own[head.joint] = *side;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Row;

    /// Of rows of these series and sides of two joints.
    fn of(rows: &[(&str, [i8; 2])]) -> Measurements {
        let row = |(series, sides): &(&str, [i8; 2])| Row {
            series: Some((*series).to_owned()),
            directions: if *sides == [0, 0] { Vec::new() } else { sides.to_vec() },
            ..Row::at(vec![0.0; 2])
        };
        Measurements {
            path: "m.csv".into(),
            behind: Vec::new(),
            rows: rows.iter().map(row).collect(),
            stations: vec![String::new()],
            markers: vec![String::new()],
            known_markers: Vec::new(),
            guessed_markers: Vec::new(),
            instruments: Vec::new(),
            base: truearm::Pose::identity(),
            poses: rows.len(),
            extra_columns: Vec::new(),
            directions_from_order: true,
            order_from_rows: false,
            sides_found: Vec::new(),
            warnings: Vec::new(),
        }
    }

    #[test]
    fn every_series_has_heads_of_its_own() {
        let data =
            of(&[("a", [0, 0]), ("a", [0, 1]), ("a", [-1, 1]), ("b", [0, 0]), ("b", [1, 1])]);
        let head = |joint, stretch, rows: &[usize]| Head { joint, stretch, rows: rows.to_vec() };
        let all = [head(0, 0, &[0, 1]), head(1, 0, &[0]), head(0, 1, &[3]), head(1, 1, &[3])];
        assert_eq!(heads(&data), all);
        let sided = with(&data, &all, &[1, 0, -1, 1]);
        let sides: Vec<_> = sided.rows.iter().map(|row| row.directions.clone()).collect();
        assert_eq!(sides, [[1, 0], [1, 1], [-1, 1], [-1, 1], [1, 1]]);
        assert_eq!(sided.sides_found, [2, 1]);
    }

    /// On both sides of the border.
    #[test]
    fn of_many_stretches_none_is_asked() {
        let names: Vec<String> = (0..101).map(|k| k.to_string()).collect();
        let series = |name: &'_ String| [(name.clone(), [0, 0]), (name.clone(), [1, 1])];
        let asked = |count: usize| {
            let rows: Vec<(String, [i8; 2])> = names[..count].iter().flat_map(series).collect();
            let rows: Vec<(&str, [i8; 2])> = rows.iter().map(|(n, s)| (&n[..], *s)).collect();
            heads(&of(&rows)).len()
        };
        assert_eq!([asked(100), asked(101)], [200, 0]);
    }

    /// Of what never moves no side differs from another, and columns of a file are what they say.
    #[test]
    fn what_never_moves_or_is_stated_has_none() {
        assert_eq!(heads(&of(&[("a", [0, 0]), ("a", [0, 0])])), []);
        let stated =
            Measurements { directions_from_order: false, ..of(&[("a", [0, 0]), ("a", [1, 1])]) };
        assert_eq!(heads(&stated), []);
    }
}
