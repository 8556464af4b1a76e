//! Dates and times of day as they stand in tables.

/// Seconds that a day has.
const DAY: f64 = 86_400.0;

/// Seconds of a date and a time of day, since the year 1970, or of a time of day
/// since midnight: `2021-03-05 12:03:55.2`, `05.03.2021 12:03:55`, `12:03:55`,
/// `2021-03-05T12:03:55+01:00`, `3/5/2021 12:03:55 PM`; `03:55.2` are minutes and seconds.
pub(super) fn seconds(text: &str) -> Option<f64> {
    seconds_beside(text, in_minutes(text))
}

/// Whether it is minutes and seconds: of two groups a fraction can only be of seconds.
pub(super) fn in_minutes(text: &str) -> bool {
    let mut groups = text.split(':');
    let last = groups.next().and(groups.next());
    groups.next().is_none() && last.is_some_and(|last| last.contains(['.', ',']))
}

/// Seconds of a date, and of a time of day in a column of its own. The date may be
/// `20210305` as well.
pub(super) fn dated(date: &str, time: &str) -> Option<f64> {
    let date = date.trim();
    if date.is_empty() {
        return None;
    }
    let digits = date.len() == 8 && date.bytes().all(|b| b.is_ascii_digit());
    let date = match date.split_once(['T', ' ']) {
        _ if digits => format!("{}-{}-{}", &date[..4], &date[4..6], &date[6..]),
        Some((date, midnight)) if seconds(midnight) == Some(0.0) => date.to_owned(),
        _ => date.to_owned(),
    };
    seconds(&format!("{date} {}", time.trim()))
}

/// The same where other cells of the column tell that two groups are minutes and seconds.
pub(super) fn seconds_beside(text: &str, minutes_first: bool) -> Option<f64> {
    let text = text.trim();
    let half = Half::of(text);
    let text = half.map_or(text, |_| text[..text.len() - 2].trim_end());
    let text = text.trim_end_matches(['Z', 'z']);
    let (date, clock) = match text.split_once(['T', ' ']) {
        Some((date, clock)) => (Some(date), clock.trim()),
        None => (None, text),
    };
    let (clock, ahead) = match clock.rfind(['+', '-']) {
        Some(at) => (clock[..at].trim_end(), offset(&clock[at..])?),
        None => (clock, 0.0),
    };
    let part = |text: &str, most: f64| {
        let value: f64 = text.replace(',', ".").parse().ok()?;
        (0.0..most).contains(&value).then_some(value)
    };
    let alone = date.is_none() && half.is_none();
    let (hours, minutes, seconds) = match clock.split(':').collect::<Vec<_>>()[..] {
        [hours, minutes, seconds] => {
            (part(hours, 24.0)?, part(minutes, 60.0)?, part(seconds, 61.0)?)
        }
        [minutes, seconds] if minutes_first && alone => {
            (0.0, part(minutes, DAY / 60.0)?, part(seconds, 60.0)?)
        }
        [hours, minutes] if !in_minutes(clock) => (part(hours, 24.0)?, part(minutes, 60.0)?, 0.0),
        _ => return None,
    };
    let hours = match half {
        None => hours,
        Some(_) if !(1.0..13.0).contains(&hours) => return None,
        Some(half) => hours % 12.0 + if half == Half::Afternoon { 12.0 } else { 0.0 },
    };
    let days = match date {
        Some(date) => days(date, half.is_some())? as f64,
        None => 0.0,
    };
    let time = ((days * 24.0 + hours) * 60.0 + minutes) * 60.0 + seconds;
    Some(time - ahead)
}

/// Of a clock of twelve hours.
#[derive(Clone, Copy, PartialEq)]
enum Half {
    Morning,
    Afternoon,
}

impl Half {
    fn of(text: &str) -> Option<Self> {
        let (_, last) = text.split_at_checked(text.len().checked_sub(2)?)?;
        match last.to_ascii_uppercase().as_str() {
            "AM" => Some(Self::Morning),
            "PM" => Some(Self::Afternoon),
            _ => None,
        }
    }
}

/// Seconds that a clock is ahead of Greenwich: `+01:00`, `-0530`, `+01`.
fn offset(text: &str) -> Option<f64> {
    let (sign, digits) = text.split_at_checked(1)?;
    let digits = digits.replace(':', "");
    let digit = |c: char| c.is_ascii_digit();
    if ![2, 4].contains(&digits.len()) || !digits.chars().all(digit) {
        return None;
    }
    let (hours, minutes) = digits.split_at(2);
    let (hours, minutes): (f64, f64) = (hours.parse().ok()?, minutes.parse().unwrap_or(0.0));
    let seconds = (hours * 60.0 + minutes) * 60.0;
    Some(if sign == "-" { -seconds } else { seconds })
}

/// Days since 1970 of `2021-03-05`, `2021/03/05` or `05.03.2021`. Slashes with the year
/// behind are days first to some and months first to others: `None`, unless a number or a
/// clock of twelve hours tells.
fn days(date: &str, twelve: bool) -> Option<i64> {
    let cut = |separator| {
        date.split(separator).map(|p| p.parse::<i64>().ok()).collect::<Option<Vec<_>>>()
    };
    let [year, month, day] = match (cut('-'), cut('/'), cut('.')) {
        (Some(p), _, _) | (_, Some(p), _) if p.len() == 3 && p[0] > 31 => [p[0], p[1], p[2]],
        (_, _, Some(p)) if p.len() == 3 => [p[2], p[1], p[0]],
        (_, Some(p), _) if p.len() == 3 && (twelve || p[1] > 12) => [p[2], p[0], p[1]],
        (_, Some(p), _) if p.len() == 3 && p[0] > 12 => [p[2], p[1], p[0]],
        _ => return None,
    };
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) || !(1900..3000).contains(&year) {
        return None;
    }
    // Howard Hinnant, days_from_civil.
    let year = if month <= 2 { year - 1 } else { year };
    let of_era = year.rem_euclid(400);
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    Some(
        year.div_euclid(400) * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year
            - 719_468,
    )
}

/// Times of a session in the order of the file: where a time of day without a date falls
/// by more than half a day, midnight has passed.
pub(super) fn past_midnight(times: &mut [Option<f64>]) {
    let (mut days, mut last) = (0.0, None);
    for time in times.iter_mut().flatten() {
        if last.is_some_and(|last| *time < last - DAY / 2.0) {
            days += 1.0;
        }
        last = Some(*time);
        *time += days * DAY;
    }
}

/// Whether it is a time of day without a date.
pub(super) fn is_of_day(text: &str) -> bool {
    seconds(text).is_some_and(|time| (0.0..DAY).contains(&time))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times() {
        for (text, value) in [
            ("12:03:55", Some(43_435.0)),
            ("1970-01-02 00:00:01", Some(86_401.0)),
            ("05.03.2021 12:03:55,5", Some(1_614_945_835.5)),
            ("2021-03-05T12:03:55.5Z", Some(1_614_945_835.5)),
            ("2021-03-05T13:03:55.5+01:00", Some(1_614_945_835.5)),
            ("2021-03-05T06:33:55.5-0530", Some(1_614_945_835.5)),
            ("3/5/2021 12:03:55.5 PM", Some(1_614_945_835.5)),
            ("3/5/2021 12:03:55.5 am", Some(1_614_902_635.5)),
            ("3/25/2021 12:03:55", Some(1_616_673_835.0)),
            ("25/3/2021 12:03:55", Some(1_616_673_835.0)),
            ("1:02:03 PM", Some(46_923.0)),
            ("13:02:03 PM", None),
            ("03/05/2021 12:03:55", None),
            ("12:03:55+1", None),
            ("25:00", None),
            ("00:37.1", Some(37.1)),
            ("61:05,5", Some(3665.5)),
            ("12:30", Some(45_000.0)),
            ("12:03:xx", None),
            ("2021-03-05 12:03.5", None),
            ("PM", None),
            ("12", None),
            ("µm", None),
        ] {
            assert_eq!(seconds(text), value, "{text}");
        }
    }

    #[test]
    fn dates_beside_times() {
        for (date, time, value) in [
            ("2021-03-05", "12:03:55", Some(1_614_945_835.0)),
            ("05.03.2021", "12:03:55", Some(1_614_945_835.0)),
            ("20210305", "12:03:55", Some(1_614_945_835.0)),
            ("2021-03-05 00:00:00", "12:03:55", Some(1_614_945_835.0)),
            ("3/5/2021", "12:03:55 PM", Some(1_614_945_835.0)),
            ("3/5/2021", "12:03:55", None),
            ("Tuesday", "12:03:55", None),
            ("2021-03-05", "03:55.5", None),
            ("", "12:03:55", None),
        ] {
            assert_eq!(dated(date, time), value, "{date} {time}");
        }
    }

    #[test]
    fn a_night_shift_goes_on_after_midnight() {
        let mut times = [Some(86_000.0), None, Some(100.0), Some(50_000.0), Some(10.0)];
        past_midnight(&mut times);
        let on = [Some(86_000.0), None, Some(86_500.0), Some(136_400.0), Some(172_810.0)];
        assert_eq!(times, on);
        // Rows that are only out of order.
        let mut times = [Some(9_000.0), Some(8_000.0)];
        past_midnight(&mut times);
        assert_eq!(times, [Some(9_000.0), Some(8_000.0)]);
    }
}
