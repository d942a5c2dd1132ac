// Segments cut at values, and what `of_piece` says of their parts put together, as in src/optics/compositing.rs.

// The part of a segment whose values lie in a piece; its length is spread evenly between its end values.
fn cut(whole: Segment, piece: Piece) -> Segment {
    let a = clamp(whole.enter, piece.begin, piece.end);
    let b = clamp(whole.leave, piece.begin, piece.end);
    let height = abs(whole.leave - whole.enter);
    // A height so small that the quotient overflows is as good as none: the piece that holds the value has all of it.
    let slope = whole.length_world / height;
    if height > 0.0 && slope < LARGEST {
        return Segment(a, b, abs(b - a) * slope);
    }
    let holds = whole.enter >= piece.begin && whole.enter < piece.end;
    return Segment(whole.enter, whole.leave, select(0.0, whole.length_world, holds));
}

// One loop for any number of pieces, one read of each: processors that draw run both sides of a branch, and read slowly.
fn of_segment(ray: Segment, span: vec2<u32>) -> vec4<f32> {
    var sum = NOTHING;
    for (var k = span.x; k <= span.y; k++) {
        let piece = pieces[k];
        if piece.is_transparent != 0u {
            continue;
        }
        var part = ray;
        if span.x != span.y {
            part = cut(ray, piece);
        }
        if part.length_world > 0.0 {
            let added = of_piece(piece, part);
            // Pieces are visited by rising value: along a falling ray each one lies in front of those before it.
            if ray.leave >= ray.enter {
                sum = over(sum, added);
            } else {
                sum = over(added, sum);
            }
        }
    }
    return sum;
}
