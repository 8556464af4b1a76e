//! The program as its user and their shell meet it.

mod cli;
mod console;
mod plumbing;
mod words;
