//! Pages of the book about the program, of what it knows of itself.

use clap::builder::StyledStr;
use clap::{Arg, ArgAction, Command};

/// The verbs of the program, in the order of its help.
pub fn verbs(program: &Command) -> impl Iterator<Item = &Command> {
    program.get_subcommands().filter(|verb| verb.get_name() != "help")
}

/// The page of the program: its verbs, what all of them take, how they end.
pub fn of_program(program: &Command) -> String {
    let mut text = head(program) + "| verb | |\n|---|---|\n";
    for verb in verbs(program) {
        let name = verb.get_name();
        text += &format!("| [{name}]({name}.md) | {} |\n", cell(verb.get_about()));
    }
    text += "\n## What all verbs take\n\n";
    text += &table("option", program.get_arguments());
    if let Some(end) = program.get_after_help() {
        text += &format!("\n```text\n{end}\n```\n");
    }
    text
}

/// The page of a verb, and of each of its parts.
pub fn of_verb(verb: &Command) -> String {
    let parts = verbs(verb).map(|part| format!("\n#{}", of_one(part)));
    of_one(verb) + &parts.collect::<String>()
}

fn of_one(verb: &Command) -> String {
    let own = || verb.get_arguments().filter(|arg| !arg.is_global_set());
    let given = table("argument", own().filter(|arg| arg.is_positional()));
    let options = table("option", own().filter(|arg| !arg.is_positional()));
    let tables = [given, options].into_iter().filter(|table| !table.is_empty());
    head(verb) + &tables.collect::<Vec<_>>().join("\n")
}

fn head(command: &Command) -> String {
    let name = command.get_bin_name().unwrap_or(command.get_name());
    let about = command.get_long_about().or(command.get_about()).map(StyledStr::to_string);
    let usage = command.clone().render_usage().to_string();
    let usage = usage.strip_prefix("Usage: ").unwrap_or(&usage);
    let about = about.unwrap_or_default();
    format!("# {name}\n\n{}.\n\n```text\n{usage}\n```\n\n", about.trim_end_matches('.'))
}

/// Nothing where there are none.
fn table<'a>(title: &str, all: impl Iterator<Item = &'a Arg>) -> String {
    let asks_for_help = |arg: &Arg| {
        matches!(arg.get_action(), ArgAction::Help | ArgAction::Version | ArgAction::HelpShort)
    };
    let shown = all.filter(|arg| !arg.is_hide_set() && !asks_for_help(arg));
    let rows: String =
        shown.map(|arg| format!("| `{}` | {} |\n", written(arg), meaning(arg))).collect();
    if rows.is_empty() { rows } else { format!("| {title} | |\n|---|---|\n{rows}") }
}

/// As it stands in a command line.
fn written(arg: &Arg) -> String {
    let names = arg.get_value_names().unwrap_or_default();
    let names: Vec<&str> = names.iter().map(|name| name.as_str()).collect();
    let values = if arg.get_action().takes_values() { names.join(" ") } else { String::new() };
    let short = arg.get_short().map(|short| format!("-{short}"));
    let flags = short.into_iter().chain(arg.get_long().map(|long| format!("--{long}")));
    let flags: Vec<String> = flags.collect();
    let words = [flags.join(", "), values];
    let words: Vec<String> = words.into_iter().filter(|word| !word.is_empty()).collect();
    words.join(" ").replace('|', "\\|")
}

/// What it is for, what may be given, and what is taken where nothing is.
fn meaning(arg: &Arg) -> String {
    let mut text = cell(arg.get_long_help().or(arg.get_help()));
    let possible = arg.get_possible_values();
    let possible: Vec<_> = possible.iter().filter(|value| !value.is_hide_set()).collect();
    if arg.get_action().takes_values() && !possible.is_empty() {
        let each = possible.iter().map(|value| match value.get_help() {
            Some(help) => format!("`{}` ({})", value.get_name(), cell(Some(help))),
            None => format!("`{}`", value.get_name()),
        });
        text += &format!("; {}", each.collect::<Vec<_>>().join(", "));
    }
    if matches!(arg.get_action(), ArgAction::Append) {
        text += "; may be given more than once";
    }
    let usual: Vec<_> = arg.get_default_values().iter().map(|v| v.to_string_lossy()).collect();
    if arg.get_action().takes_values() && !usual.is_empty() {
        text += &format!("; `{}` if not given", usual.join(" "));
    }
    text
}

/// Text as a cell of a table holds it.
fn cell(text: Option<&StyledStr>) -> String {
    let text = text.map(StyledStr::to_string).unwrap_or_default();
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ").replace('|', "\\|").replace('<', "&lt;")
}
