//! The temperature sensor's register, as its data sheet (TI SBOS249, table 4)
//! gives it.

use embedded_hal::i2c::ErrorKind;
use embedded_hal_mock::eh1::i2c::{Mock, Transaction};
use truearm::sensor::{TEMPERATURE_SENSOR, read_temperature};

#[test]
fn temperatures_of_the_data_sheet() {
    for (register, celsius) in [
        ([0x7f, 0xf0], 127.9375),
        ([0x64, 0x00], 100.0),
        ([0x19, 0x00], 25.0),
        ([0x00, 0x40], 0.25),
        ([0x00, 0x00], 0.0),
        ([0xff, 0xc0], -0.25),
        ([0xe7, 0x00], -25.0),
        ([0xc9, 0x00], -55.0),
    ] {
        let expected = Transaction::write_read(TEMPERATURE_SENSOR, vec![0], register.to_vec());
        let mut bus = Mock::new(&[expected]);
        assert_eq!(read_temperature(&mut bus, TEMPERATURE_SENSOR), Ok(celsius));
        bus.done();
    }
}

#[test]
fn a_bus_error_is_passed_on() {
    let expected = Transaction::write_read(0x4f, vec![0], vec![0, 0]).with_error(ErrorKind::Bus);
    let mut bus = Mock::new(&[expected]);
    assert_eq!(read_temperature(&mut bus, 0x4f), Err(ErrorKind::Bus));
    bus.done();
}
