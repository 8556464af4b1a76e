#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| truearm_fuzz::readers(data));
