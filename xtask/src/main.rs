//! `cargo xtask VERB`: what continuous integration runs, and what a developer
//! runs before it. One file a verb.

mod bench;
mod beside;
mod board;
mod book;
mod budgets;
mod c;
mod ci;
mod controller;
mod counts;
mod demo;
mod embassy;
mod end_to_end;
mod firmware;
mod image;
mod image_refusals;
mod least_squares;
mod log;
mod m7;
mod package;
mod pages;
mod peers;
#[path = "../../batch/benches/arm/poses.rs"]
mod poses;
mod proof;
mod python;
mod qemu;
#[path = "../../tests/firmware/src/records.rs"]
mod records;
mod reidentification_poses;
mod reidentify;
mod run;
mod same_work;
mod sigma;
mod store;
mod study;
mod test;
mod tools;
mod touches;
mod vectors;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(name = "cargo xtask", about = "Tasks of the truearm repository")]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Host tests, and beside them everything that is built for a controller
    Test,
    /// Everything that is built for a controller: image, log, async loop, C library
    Controller {
        /// And the proof at every level, Miri, and half a minute of fuzzing
        #[arg(long)]
        thorough: bool,
    },
    /// Build the controller image, prove it panic-free, run it under QEMU
    Firmware {
        /// Parameter blob to run with instead of the shipped one
        #[arg(long)]
        blob: Option<PathBuf>,
    },
    /// That nothing a controller calls can panic, for every target and level
    Proof,
    /// Instructions, text, stack and static RAM on the controller
    Budgets,
    /// The C library: its header, and a C program on the host and under QEMU
    C {
        /// Only rewrite the header from the crate
        #[arg(long)]
        header: bool,
    },
    /// Log frames of the controller, decoded
    Log,
    /// Parameters in an EEPROM: the store's size, and the board under QEMU
    Store,
    /// Build the crate as it would be published, and run its examples
    Package,
    /// Build the Python wheel and test it in a bare environment
    Python,
    /// Times of a pose, alone and in batches, as ratios of one run
    Bench,
    /// Instructions of the host's kernels, counted by valgrind
    Counts,
    /// Pinocchio, k and others beside truearm: sets them up in target/peers, times all
    Peers,
    /// Open report.html of every verb, or these, in Chromium where there is one
    Pages {
        /// Pages to open
        pages: Vec<PathBuf>,
    },
    /// Build the book of docs into target/book; installs mdBook where there is none
    Book,
    /// Rewrite the shipped blobs and vector files
    Vectors {
        /// Parameter blob of a six-joint arm; the shipped one if not given
        blob: Option<PathBuf>,
    },
    /// Figures too long for a test run
    #[command(after_help = study::OF_ARMS)]
    Study {
        #[command(subcommand)]
        study: study::Study,
    },
    /// An arm that notices what happened to it and mends itself
    Demo(demo::Options),
    /// Formatting, lints and everything of `test`
    Ci,
}

fn main() -> ExitCode {
    let result = match Arguments::parse().verb {
        Verb::Test => test::run(false),
        Verb::Controller { thorough } => controller::run(thorough),
        Verb::Firmware { blob } => firmware::run(blob.as_deref()),
        Verb::Proof => tools::ensure().and_then(|()| proof::usual()).and_then(|()| proof::others()),
        Verb::Budgets => firmware::budgets(),
        Verb::C { header: true } => c::check_header(true),
        Verb::C { header: false } => c::run(),
        Verb::Log => tools::ensure().and_then(|()| log::check()),
        Verb::Store => tools::ensure().and_then(|()| store::run()),
        Verb::Package => package::run(),
        Verb::Python => python::run(),
        Verb::Bench => bench::run(),
        Verb::Counts => counts::run(),
        Verb::Peers => peers::run(),
        Verb::Pages { pages } => pages::run(&pages),
        Verb::Book => book::run(),
        Verb::Vectors { blob } => vectors::ship(blob.as_deref()),
        Verb::Study { study } => study::run(&study),
        Verb::Demo(options) => tools::ensure().and_then(|()| demo::run(&options)),
        Verb::Ci => ci::run(),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("\nFAILED {error}");
            ExitCode::FAILURE
        }
    }
}
