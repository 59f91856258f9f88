//! The picture of a state.

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Axis, Block, Chart, Dataset, GraphType, Paragraph, Wrap};
use slider_proto::TimerState;

use super::state::{Link, Message, Passing, State};
use crate::axis::{covering_ticks, range, widened};
use crate::outcome::{Kind, Outcome};
use crate::report::{fitted_m, main_value};
use crate::text::{degrees_of_freedom, plus_minus, significant};

const SIDE_WIDTH: u16 = 34;
const SIDE_FROM: u16 = 70;
const SOFT: Style = Style::new().fg(Color::DarkGray);
const GOOD: Style = Style::new().fg(Color::Green);
const BAD: Style = Style::new().fg(Color::Red).add_modifier(Modifier::BOLD);
const POINTS: Style = Style::new().fg(Color::Cyan);
const FIT: Style = Style::new().fg(Color::Yellow);

/// Draws a state on the whole frame, whatever its size; what has no room is left out, the result last.
pub fn draw(frame: &mut Frame<'_>, state: &State) {
    let area = frame.area();
    let message_lines = match area.height {
        0..=3 => 0,
        // No room for a figure: messages take its place.
        4..=8 => area.height - 3,
        9..=15 => 1,
        _ => 3,
    };
    let [top, result, body, messages, keys] = Layout::vertical([
        Constraint::Length(1),
        Constraint::Length(1),
        Constraint::Min(0),
        Constraint::Length(message_lines),
        Constraint::Length(u16::from(area.height > 3)),
    ])
    .areas(area);
    frame.render_widget(header(state), top);
    frame.render_widget(result_line(state), result);
    let charts = if area.width >= SIDE_FROM && body.height >= 6 {
        let [charts, side] = Layout::horizontal([Constraint::Min(0), Constraint::Length(SIDE_WIDTH)]).areas(body);
        draw_side(frame, state, side);
        charts
    } else {
        body
    };
    draw_charts(frame, state, charts);
    let lines: Vec<Line<'_>> = state.messages.iter().rev().take(message_lines.into()).rev().map(message).collect();
    frame.render_widget(Paragraph::new(lines), messages);
    let help = if area.width < 32 { "a arm s stop q quit" } else { "a arm  s stop  q quit  \u{2191}\u{2193} runs" };
    frame.render_widget(Line::styled(help, SOFT), keys);
}

fn header(state: &State) -> Line<'_> {
    let link = match &state.link {
        Link::Waiting => Span::styled("waiting for a port", SOFT),
        Link::Open(port) => Span::styled(port.as_str(), GOOD),
        Link::Lost(_) => Span::styled("NOT CONNECTED", BAD),
    };
    let timer = match state.timer {
        None => "",
        Some(TimerState::Idle) => "idle",
        Some(TimerState::Armed) => "ARMED",
        Some(TimerState::Running) => "RUNNING",
        Some(TimerState::SelfTest) => "self-test",
    };
    let mut spans = vec![link, Span::raw("  "), Span::styled(timer, Modifier::BOLD)];
    if state.errors > 0 {
        let plural = if state.errors == 1 { "" } else { "s" };
        spans.push(Span::styled(format!("  {} error{plural}", state.errors), BAD));
    }
    spans.push(Span::styled(format!("  {} bytes", state.bytes), SOFT));
    Line::from(spans)
}

fn result_line(state: &State) -> Line<'_> {
    if let Some(outcome) = state.shown() {
        let Some((symbol, unit, value)) = main_value(outcome) else {
            return Line::styled(format!("run {}: no result", outcome.run), BAD);
        };
        let result = format!("{symbol} = {} {unit}", plus_minus(value.value, value.expanded));
        return Line::from(vec![
            Span::styled(result, Modifier::BOLD),
            Span::styled(format!("  k = {}  run {}", significant(value.coverage_k, 3), outcome.run), SOFT),
        ]);
    }
    match &state.passing {
        Some(passing) => {
            let speed = passing
                .last_speed_m_s()
                .map_or_else(String::new, |v| format!("v \u{2248} {} m/s  ", significant(v, 3)));
            Line::from(vec![
                Span::styled(speed, Modifier::BOLD),
                Span::styled(format!("run {}, {} edges", passing.run, passing.edges), SOFT),
            ])
        }
        None => Line::styled("no run yet", SOFT),
    }
}

fn message(message: &Message) -> Line<'_> {
    let text =
        if message.count > 1 { format!("{} ({} times)", message.text, message.count) } else { message.text.clone() };
    Line::styled(text, if message.is_error { BAD } else { SOFT })
}

fn kind(kind: Kind) -> (&'static str, Style) {
    match kind {
        Kind::Uniform => ("uniform", GOOD),
        Kind::Accelerated => ("accelerated", GOOD),
        Kind::Neither => ("NEITHER uniform nor accelerated", BAD),
    }
}

fn draw_side(frame: &mut Frame<'_>, state: &State, area: Rect) {
    let details = state.shown().map(details).unwrap_or_default();
    let height = if details.is_empty() { 0 } else { details.len() as u16 + 2 };
    let [upper, lower] = Layout::vertical([Constraint::Length(height), Constraint::Min(0)]).areas(area);
    frame.render_widget(
        Paragraph::new(details).wrap(Wrap { trim: true }).block(Block::bordered().title("result")),
        upper,
    );
    let room = usize::from(lower.height.saturating_sub(2));
    let newest = state.outcomes.len().saturating_sub(1);
    let shown = state.chosen.unwrap_or(newest);
    // The chosen run stays in sight, the newest ones otherwise.
    let end = (shown + 1).max(room).min(state.outcomes.len());
    let lines: Vec<Line<'_>> = state
        .outcomes
        .iter()
        .enumerate()
        .take(end)
        .skip(end.saturating_sub(room))
        .map(|(index, outcome)| {
            let style = match state.shown() {
                Some(_) if index == shown => Style::new().add_modifier(Modifier::REVERSED),
                _ => Style::new(),
            };
            Line::styled(run_line(outcome), style)
        })
        .collect();
    frame.render_widget(Paragraph::new(lines).block(Block::bordered().title("runs")), lower);
}

fn run_line(outcome: &Outcome) -> String {
    let value = main_value(outcome).map_or_else(
        || "no result".to_owned(),
        |(symbol, unit, value)| format!("{symbol} {} {unit}", plus_minus(value.value, value.expanded)),
    );
    let warned = if outcome.warnings.is_empty() { "" } else { " !" };
    format!("{:>5}  {value}{warned}", outcome.run)
}

fn details(outcome: &Outcome) -> Vec<Line<'static>> {
    let mut lines = Vec::new();
    let mut fact = |name: &'static str, text: String| {
        lines.push(Line::from(vec![Span::styled(format!("{name:<8}"), SOFT), Span::raw(text)]));
    };
    if let Some((symbol, unit, value)) = main_value(outcome) {
        fact(symbol, format!("{} {unit}", plus_minus(value.value, value.expanded)));
        fact("k", format!("{} (dof {})", significant(value.coverage_k, 3), degrees_of_freedom(value.dof)));
    }
    if let Some(v0) = &outcome.v0_m_s {
        fact("v0", format!("{} m/s", plus_minus(v0.value, v0.expanded)));
    }
    let left_out =
        if outcome.outliers.is_empty() { String::new() } else { format!(", {} left out", outcome.outliers.len()) };
    fact("points", format!("{}{left_out}", outcome.t_s.len()));
    fact("1 - R2", format!("{:.1e}", 1.0 - outcome.r_squared));
    fact("scatter", format!("{} um", significant(outcome.residual_std * 1e6, 3)));
    let (words, style) = kind(outcome.kind);
    lines.push(Line::styled(words, style));
    lines
}

fn draw_charts(frame: &mut Frame<'_>, state: &State, area: Rect) {
    if area.height < 4 || area.width < 20 {
        return;
    }
    match (state.shown(), &state.passing) {
        (Some(outcome), _) if area.height >= 12 => {
            let [upper, lower] = Layout::vertical([Constraint::Fill(3), Constraint::Fill(2)]).areas(area);
            position_chart(frame, outcome, upper);
            residual_chart(frame, outcome, lower);
        }
        (Some(outcome), _) => position_chart(frame, outcome, area),
        (None, Some(passing)) => passing_chart(frame, passing, area),
        (None, None) => {}
    }
}

fn position_chart(frame: &mut Frame<'_>, outcome: &Outcome, area: Rect) {
    let points: Vec<(f64, f64)> = outcome.t_s.iter().zip(&outcome.x_m).map(|(t, x)| (t * 1e3, x * 1e3)).collect();
    let (start, end) = range(outcome.t_s.iter().copied());
    let curve: Vec<(f64, f64)> = (0..=200)
        .map(|i| start + (end - start) * f64::from(i) / 200.0)
        .map(|t| (t * 1e3, fitted_m(outcome, t) * 1e3))
        .collect();
    let sets =
        vec![set(&curve, Marker::Braille, GraphType::Line, FIT), set(&points, Marker::Dot, GraphType::Scatter, POINTS)];
    let ordinates = range(points.iter().chain(&curve).map(|point| point.1));
    chart(frame, area, "x / mm", sets, (start * 1e3, end * 1e3), ordinates);
}

fn residual_chart(frame: &mut Frame<'_>, outcome: &Outcome, area: Rect) {
    let points: Vec<(f64, f64)> =
        outcome.t_s.iter().zip(&outcome.residuals_m).map(|(t, r)| (t * 1e3, r * 1e6)).collect();
    let (start, end) = range(points.iter().map(|point| point.0));
    let half = points.iter().map(|point| point.1.abs()).filter(|r| r.is_finite()).fold(0.0, f64::max);
    let zero = [(start, 0.0), (end, 0.0)];
    let sets =
        vec![set(&zero, Marker::Braille, GraphType::Line, SOFT), set(&points, Marker::Dot, GraphType::Scatter, POINTS)];
    chart(frame, area, "residual / um", sets, (start, end), (-half, half));
}

fn passing_chart(frame: &mut Frame<'_>, passing: &Passing, area: Rect) {
    let points: Vec<(f64, f64)> = passing.points.iter().map(|(t, x)| (t * 1e3, x * 1e3)).collect();
    let abscissas = range(points.iter().map(|point| point.0));
    let ordinates = range(points.iter().map(|point| point.1));
    chart(frame, area, "x / mm", vec![set(&points, Marker::Dot, GraphType::Scatter, POINTS)], abscissas, ordinates);
}

fn set(points: &[(f64, f64)], marker: Marker, graph: GraphType, style: Style) -> Dataset<'_> {
    Dataset::default().data(points).marker(marker).graph_type(graph).style(style)
}

fn chart(frame: &mut Frame<'_>, area: Rect, title: &'static str, sets: Vec<Dataset<'_>>, x: (f64, f64), y: (f64, f64)) {
    // The widget spreads its labels evenly between the ends, so the ends are round numbers.
    let axis = |range: (f64, f64), most: u16| {
        let marks = covering_ticks(if range.0 < range.1 { range } else { widened(range) }, u32::from(most));
        let ends = marks.first().zip(marks.last()).map_or(range, |(first, last)| (first.0, last.0));
        Axis::default().bounds([ends.0, ends.1]).labels(marks.into_iter().map(|mark| mark.1)).style(SOFT)
    };
    let widget = Chart::new(sets)
        .block(Block::bordered().title(title).title_bottom(Line::from("t / ms").right_aligned()))
        .x_axis(axis(x, (area.width / 8).clamp(1, 8)))
        .y_axis(axis(y, (area.height / 3).clamp(1, 6)))
        .legend_position(None);
    frame.render_widget(widget, area);
}
