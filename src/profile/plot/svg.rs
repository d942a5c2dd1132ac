//! SVG 1.1: the few elements that a plot needs.

use std::fmt::Write;

/// Where a text stands about its point.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A picture that grows by elements, the later in front.
pub(super) struct Svg(String);

impl Svg {
    /// On white.
    pub(super) fn new([width, height]: [f64; 2], title: &str) -> Self {
        let mut svg = Self(String::new());
        svg.push(format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             font-family=\"'DejaVu Sans', Verdana, Helvetica, Arial, sans-serif\">\n<title>{}</title>\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>",
            escaped(title)
        ));
        svg
    }

    fn push(&mut self, element: std::fmt::Arguments<'_>) {
        // A string takes anything.
        let _ = writeln!(self.0, "{element}");
    }

    pub(super) fn text(&mut self, at: [f64; 2], size: f64, color: &str, anchor: Anchor, text: &str) {
        self.lettering(at, (size, "normal"), color, anchor, text);
    }

    pub(super) fn bold(&mut self, at: [f64; 2], size: f64, text: &str) {
        self.lettering(at, (size, "bold"), "#222222", Anchor::Start, text);
    }

    fn lettering(&mut self, [x, y]: [f64; 2], (size, weight): (f64, &str), color: &str, anchor: Anchor, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let text = escaped(text);
        self.push(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" font-weight=\"{weight}\" fill=\"{color}\" text-anchor=\"{anchor}\">{text}</text>"
        ));
    }

    /// A straight line; `dash` lists strokes and gaps, empty for none.
    pub(super) fn line(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], color: &str, width: f64, dash: &str) {
        let dash = dashed(dash);
        self.push(format_args!(
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{color}\" stroke-width=\"{width}\"{dash}/>"
        ));
    }

    pub(super) fn polyline(&mut self, points: &[[f64; 2]], color: &str, width: f64, dash: &str) {
        let (points, dash) = (listed(points), dashed(dash));
        self.push(format_args!(
            "<polyline points=\"{points}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"{dash}/>"
        ));
    }

    pub(super) fn polygon(&mut self, points: &[[f64; 2]], color: &str) {
        let points = listed(points);
        self.push(format_args!("<polygon points=\"{points}\" fill=\"{color}\"/>"));
    }

    pub(super) fn rect(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2], color: &str) {
        self.push(format_args!(
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width}\" height=\"{height}\" fill=\"{color}\"/>"
        ));
    }

    pub(super) fn circle(&mut self, [x, y]: [f64; 2], radius: f64, color: &str) {
        self.push(format_args!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{color}\"/>"));
    }

    pub(super) fn finish(mut self) -> String {
        self.push(format_args!("</svg>"));
        self.0
    }
}

fn listed(points: &[[f64; 2]]) -> String {
    let mut list = String::new();
    for [x, y] in points {
        let _ = write!(list, "{x:.1},{y:.1} ");
    }
    list.trim_end().to_owned()
}

fn dashed(dash: &str) -> String {
    if dash.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{dash}\"") }
}

/// Text in XML; control characters, which XML has no way to write, are left out.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for c in text.chars().filter(|c| !c.is_control()) {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => {}
            c => escaped.push(c),
        }
    }
    escaped
}
