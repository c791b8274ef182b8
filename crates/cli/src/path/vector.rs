//! Vectors in space.
#![expect(clippy::many_single_char_names, reason = "coordinates have such names")]

pub(super) type Vector = [f64; 3];

pub(super) fn add([a, b, c]: Vector, [x, y, z]: Vector) -> Vector {
    [a + x, b + y, c + z]
}

pub(super) fn sub([a, b, c]: Vector, [x, y, z]: Vector) -> Vector {
    [a - x, b - y, c - z]
}

pub(super) fn scale(vector: Vector, by: f64) -> Vector {
    vector.map(|it| it * by)
}

pub(super) fn dot([a, b, c]: Vector, [x, y, z]: Vector) -> f64 {
    a * x + b * y + c * z
}

pub(super) fn cross([a, b, c]: Vector, [x, y, z]: Vector) -> Vector {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

pub(super) fn norm(vector: Vector) -> f64 {
    dot(vector, vector).sqrt()
}

pub(super) fn distance(from: Vector, to: Vector) -> f64 {
    norm(sub(to, from))
}

/// The point that lies so far, 0 to 1, on the way.
pub(super) fn between(from: Vector, to: Vector, part: f64) -> Vector {
    add(from, scale(sub(to, from), part))
}

/// How far a point is from the nearest one of a segment.
pub(super) fn off(point: Vector, from: Vector, to: Vector) -> f64 {
    let way = sub(to, from);
    let square = dot(way, way);
    let part = if square > 0.0 { (dot(sub(point, from), way) / square).clamp(0.0, 1.0) } else { 0.0 };
    distance(point, add(from, scale(way, part)))
}
