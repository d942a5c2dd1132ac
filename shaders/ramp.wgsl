// Segments cut at values, as in src/optics/compositing.rs.

// The part of a segment whose values lie in piece k; its length is spread evenly between its end values.
fn cut(whole: Segment, k: u32) -> Segment {
    let begin = pieces[k].begin;
    let end = pieces[k].end;
    let a = clamp(whole.enter, begin, end);
    let b = clamp(whole.leave, begin, end);
    let height = abs(whole.leave - whole.enter);
    // A height so small that the quotient overflows is as good as none: the piece that holds the value has all of it.
    let slope = whole.length_world / height;
    if height > 0.0 && slope < LARGEST {
        return Segment(a, b, abs(b - a) * slope);
    }
    let holds = whole.enter >= begin && whole.enter < end;
    return Segment(whole.enter, whole.leave, select(0.0, whole.length_world, holds));
}
