//! The serial line takes the time that its rate says, both ways, and loses nothing it should not.

mod common;

use slider_sim::{Pin, SimError, millis};

/// UBRR 34 with U2X: 8 * 35 cycles a bit, 10 bits a byte.
const BYTE: u64 = 2800;

#[test]
fn polled_bytes_leave_one_byte_time_apart() -> Result<(), SimError> {
    let mut mcu = common::load("uart", &[]);
    mcu.watch(Pin::D13);
    mcu.run_for(millis(2))?;
    let sent = mcu.take_sent();
    assert_eq!(sent.iter().map(|sent| sent.byte).collect::<Vec<_>>(), b"ok\n");
    assert_eq!(mcu.byte_cycles(), BYTE);
    for pair in sent.windows(2) {
        assert_eq!(pair[1].cycle - pair[0].cycle, BYTE);
        assert_eq!(pair[1].started, pair[0].cycle);
    }
    let changes = mcu.changes(Pin::D13);
    // The program waits for TXC: not before the last stop bit, and no longer than a turn of its loop.
    let done = changes[1].cycle;
    assert!((sent[2].cycle..sent[2].cycle + 20).contains(&done), "{done} {sent:?}");
    Ok(())
}

#[test]
fn an_echo_keeps_every_byte_and_the_rate() -> Result<(), SimError> {
    let mut mcu = common::load("uart", &[]);
    mcu.run_for(millis(2))?;
    mcu.take_sent();
    let text: Vec<u8> = (0..1000).map(|i| (i * 7) as u8).collect();
    let start = mcu.cycle();
    mcu.send(&text);
    mcu.run_for(1003 * BYTE)?;
    let sent = mcu.take_sent();
    assert_eq!(sent.iter().map(|sent| sent.byte).collect::<Vec<_>>(), text);
    assert!(sent[0].cycle >= start + 2 * BYTE);
    for pair in sent.windows(2) {
        assert!(pair[1].cycle - pair[0].cycle >= BYTE);
    }
    assert!(sent[999].cycle < start + 1001 * BYTE + 500);
    assert_eq!(mcu.lost(), 0);
    let rx = mcu.interrupts().of("USART_RX").expect("a vector");
    assert_eq!(rx.runs, 1000);
    assert!(rx.longest_run > 20 && rx.longest_run < 200, "{rx:?}");
    assert!(rx.longest_latency < 200, "{rx:?}");
    Ok(())
}

#[test]
fn a_receiver_that_nobody_reads_keeps_three_bytes_and_flags_the_overrun() -> Result<(), SimError> {
    let mut mcu = common::load("uart", &["DEAF"]);
    mcu.run_for(millis(2))?;
    mcu.send(b"12345");
    mcu.run_for(6 * BYTE)?;
    assert_eq!(mcu.lost(), 2);
    Ok(())
}

#[test]
fn a_host_may_keep_its_own_rate() -> Result<(), SimError> {
    let mut mcu = common::load("uart", &[]);
    mcu.run_for(millis(2))?;
    mcu.take_sent();
    mcu.set_host_baud(Some(38_400.0));
    let start = mcu.cycle();
    mcu.send(b"a");
    mcu.run_for(millis(1))?;
    let sent = mcu.take_sent();
    // 10 / 38400 s = 4166.7 cycles to come in, 2800 to go out, an interrupt between.
    assert!((4167 + BYTE..4167 + BYTE + 200).contains(&(sent[0].cycle - start)), "{sent:?} {start}");
    Ok(())
}
