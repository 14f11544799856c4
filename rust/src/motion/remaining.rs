//! What is left of a path.

/// A point x, y [m].
type Point = (f64, f64);

/// A path of at least two points from its point nearest to `here` on, at most so much of it [m].
pub fn remaining(path: &[Point], here: Point, length: f64) -> Vec<Point> {
    let feet = path.windows(2).map(|leg| foot(leg[0], leg[1], here));
    let mut nearest = (f64::INFINITY, 0, here); // squared distance, leg, foot
    for (leg, foot) in feet.enumerate() {
        let (dx, dy) = (foot.0 - here.0, foot.1 - here.1);
        let square = dx * dx + dy * dy;
        if square < nearest.0 {
            nearest = (square, leg, foot);
        }
    }
    let mut rest = vec![nearest.2];
    rest.extend(&path[nearest.1 + 1..]);
    let mut arc = vec![0.0];
    for leg in rest.windows(2) {
        arc.push(arc[arc.len() - 1] + (leg[1].0 - leg[0].0).hypot(leg[1].1 - leg[0].1));
    }
    if arc[arc.len() - 1] > length {
        let last = arc.partition_point(|&driven| driven <= length) - 1;
        let share =
            |from: f64, to: f64| (to - from) / (arc[last + 1] - arc[last]) * (length - arc[last]) + from;
        let (from, to) = (rest[last], rest[last + 1]);
        let end = (share(from.0, to.0), share(from.1, to.1));
        rest.truncate(arc.partition_point(|&driven| driven < length));
        rest.push(end);
    }
    rest
}

/// The point of a leg that is nearest.
fn foot(from: Point, to: Point, here: Point) -> Point {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let square = (dx * dx + dy * dy).max(1e-12);
    let along = (((here.0 - from.0) * dx + (here.1 - from.1) * dy) / square).clamp(0.0, 1.0);
    (from.0 + along * dx, from.1 + along * dy)
}
