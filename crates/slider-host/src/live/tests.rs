use std::fmt::Write;

use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::Buffer;
use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use slider_proto::TimerState;

use super::*;
use crate::outcome::{Kind, Outcome, Value};
use crate::sheet::Sheet;

fn outcome(run: u16, speed: f64) -> Box<Outcome> {
    let x_m = Sheet::nominal().positions_m();
    let residuals_m: Vec<f64> = (0..x_m.len()).map(|i| 2e-5 * (i as f64 * 1.3).sin()).collect();
    let t_s = x_m.iter().zip(&residuals_m).map(|(x, r)| (x - r) / speed).collect();
    Box::new(Outcome {
        run,
        degree: 1,
        coefficients: vec![0.0, speed],
        std_errors: vec![1e-5, 0.001],
        t_s,
        x_m,
        residuals_m,
        residual_stds_m: vec![],
        residual_std: 1.4e-5,
        r_squared: 0.999_99,
        speed_m_s: Some(Value { value: speed, std: 0.001, dof: 24.0, expanded: 0.0021, coverage_k: 2.06 }),
        v0_m_s: None,
        accel_m_s2: None,
        kind: Kind::Uniform,
        outliers: vec![],
        warnings: vec![],
    })
}

fn text(buffer: &Buffer) -> String {
    let mut text = String::new();
    for y in 0..buffer.area.height {
        let line: String = (0..buffer.area.width).map(|x| buffer[(x, y)].symbol()).collect();
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

fn picture(state: &State, width: u16, height: u16) -> String {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
    terminal.draw(|frame| draw(frame, state)).unwrap();
    text(terminal.backend().buffer())
}

/// Connected, two runs done, a damaged frame on the way.
fn after_two_runs() -> State {
    let mut state = State::default();
    state.apply(Event::Connected { port: "/dev/rfcomm0".to_owned() });
    state.apply(Event::Bytes(4096));
    state.apply(Event::Timer(TimerState::Armed));
    state.apply(Event::Outcome(outcome(1, 0.229)));
    state.apply(Event::Error("a damaged frame of 17 bytes".to_owned()));
    let mut second = outcome(2, 0.5);
    second.warnings.push("edge 7 is late".to_owned());
    state.apply(Event::Outcome(second));
    state
}

fn passing() -> State {
    let mut state = after_two_runs();
    state.apply(Event::Timer(TimerState::Running));
    for (index, x) in Sheet::nominal().positions_m().into_iter().take(12).enumerate() {
        state.apply(Event::Edge { run: 3, t_s: x / 0.395, x_m: (index < 10).then_some(x) });
    }
    state
}

/// `REGENERATE=1 cargo test -p slider-host live` remakes the pictures.
fn compare(name: &str, picture: &str) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/live/").to_owned() + name;
    if std::env::var_os("REGENERATE").is_some() {
        std::fs::write(&path, picture).unwrap();
    }
    let golden = std::fs::read_to_string(&path).unwrap();
    assert!(golden == picture, "{name} differs from what is drawn:\n{picture}");
}

#[test]
fn the_pictures_are_those_that_were_looked_at() {
    for (width, height) in [(80, 24), (120, 40), (20, 6)] {
        compare(&format!("result-{width}x{height}.txt"), &picture(&after_two_runs(), width, height));
        compare(&format!("passing-{width}x{height}.txt"), &picture(&passing(), width, height));
    }
}

#[test]
fn the_result_is_the_last_thing_to_go() {
    let state = after_two_runs();
    for (width, height) in [(200, 60), (80, 24), (40, 10), (20, 6), (20, 2)] {
        let picture = picture(&state, width, height);
        assert!(picture.contains("v = 0.5000 ± 0.0021"), "{width}x{height}\n{picture}");
    }
}

#[test]
fn no_size_and_no_numbers_break_the_picture() {
    let mut odd = after_two_runs();
    let mut broken = outcome(3, f64::NAN);
    broken.residuals_m.truncate(3);
    odd.apply(Event::Outcome(broken));
    let mut empty = outcome(4, 0.3);
    empty.t_s.clear();
    empty.x_m.clear();
    empty.coefficients.clear();
    empty.speed_m_s = None;
    let mut bare = after_two_runs();
    bare.apply(Event::Outcome(empty));
    let mut huge = outcome(5, 1e-300);
    huge.t_s.push(f64::MAX);
    huge.x_m.push(-f64::MAX);
    let mut far = State::default();
    far.apply(Event::Outcome(huge));
    for state in [State::default(), after_two_runs(), passing(), odd, bare, far] {
        for width in (0..130).step_by(7).chain([1, 2, 3]) {
            for height in (0..45).step_by(3).chain([1, 2]) {
                picture(&state, width, height);
            }
        }
    }
}

#[test]
fn keys_ask_and_choose() {
    let mut state = after_two_runs();
    let mut press = |code| {
        let request = state.key(KeyEvent::new(code, KeyModifiers::NONE));
        (request, state.shown().map(|outcome| outcome.run))
    };
    assert_eq!(press(KeyCode::Char('a')), (Some(Request::Arm), Some(2)));
    assert_eq!(press(KeyCode::Char('s')), (Some(Request::Stop), Some(2)));
    assert_eq!(press(KeyCode::Char('q')), (Some(Request::Quit), Some(2)));
    assert_eq!(press(KeyCode::Char('x')), (None, Some(2)));
    assert_eq!(press(KeyCode::Up), (None, Some(1)));
    assert_eq!(press(KeyCode::Up), (None, Some(1)));
    assert_eq!(press(KeyCode::Down), (None, Some(2)));
    assert_eq!(press(KeyCode::Down), (None, Some(2)));
    let interrupt = KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL);
    assert_eq!(state.key(interrupt), Some(Request::Quit));
    assert_eq!(State::default().key(KeyEvent::new(KeyCode::Up, KeyModifiers::NONE)), None);
}

#[test]
fn the_view_follows_the_newest_run_unless_one_is_chosen() {
    let mut state = after_two_runs();
    state.apply(Event::Outcome(outcome(3, 0.4)));
    assert_eq!(state.shown().map(|outcome| outcome.run), Some(3));
    state.key(KeyEvent::new(KeyCode::Up, KeyModifiers::NONE));
    state.apply(Event::Outcome(outcome(4, 0.4)));
    assert_eq!(state.shown().map(|outcome| outcome.run), Some(2));
    state.key(KeyEvent::new(KeyCode::Down, KeyModifiers::NONE));
    state.key(KeyEvent::new(KeyCode::Down, KeyModifiers::NONE));
    state.apply(Event::Outcome(outcome(5, 0.4)));
    assert_eq!(state.shown().map(|outcome| outcome.run), Some(5), "the newest was reached");
    for _ in 0..3 {
        state.key(KeyEvent::new(KeyCode::Up, KeyModifiers::NONE));
    }
    // Still the same run when the oldest ones are forgotten.
    for run in 6..=501 {
        state.apply(Event::Outcome(outcome(run, 0.4)));
    }
    assert_eq!(state.shown().map(|outcome| outcome.run), Some(2));
}

#[test]
fn a_lost_line_and_repeated_errors_are_seen() {
    let mut state = after_two_runs();
    for _ in 0..3 {
        state.apply(Event::Error("no answer".to_owned()));
    }
    state.apply(Event::Disconnected { reason: "/dev/rfcomm0: the other side hung up".to_owned() });
    let picture = picture(&state, 80, 24);
    for text in ["NOT CONNECTED", "4 errors", "no answer (3 times)", "hung up"] {
        assert!(picture.contains(text), "{text}\n{picture}");
    }
    assert!(!picture.contains("ARMED"));
}

#[test]
fn control_characters_do_not_reach_the_terminal() {
    let mut state = State::default();
    state.apply(Event::Error("bad\u{1b}[2J\u{7}\r\nname".to_owned()));
    state.apply(Event::Connected { port: "\u{1b}]0;x\u{7}".to_owned() });
    let mut terminal = Terminal::new(TestBackend::new(80, 24)).unwrap();
    terminal.draw(|frame| draw(frame, &state)).unwrap();
    let cells = terminal.backend().buffer().content();
    assert!(cells.iter().all(|cell| !cell.symbol().contains(char::is_control)));
}
