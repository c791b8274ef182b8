//! Points as text: x, y and z on each line, separated by commas, semicolons, tabs or spaces. A line of names may come
//! first, and then says which columns they are. An empty line ends a stroke; what follows a `#` is a comment.

use super::{Error, Pen, Placement, Waypoint};

/// Where x, y and z are, and whether there may be more.
#[derive(Clone, Copy)]
struct Columns {
    places: [usize; 3],
    are_named: bool,
}

pub(super) fn read(text: &str, placement: &Placement) -> Result<Vec<Waypoint>, Error> {
    let mut pen = Pen::new(*placement);
    let mut columns = None;
    let mut is_drawing = false;
    for (number, line) in (1..).zip(text.lines()) {
        let content = line.split('#').next().unwrap_or_default().trim();
        if content.is_empty() {
            // A line that is a comment ends nothing.
            is_drawing &= line.contains('#');
            continue;
        }
        let fields = split(content);
        let refused = |message: String| Error::at(number, message);
        if columns.is_none() && fields.iter().all(|field| field.parse::<f64>().is_err()) {
            columns = Some(named(&fields).map_err(refused)?);
            continue;
        }
        let columns = *columns.get_or_insert(Columns { places: [0, 1, 2], are_named: false });
        let at = point(&fields, columns).map_err(refused)?;
        if is_drawing { pen.draw(at, number) } else { pen.start(at, number) }?;
        is_drawing = true;
    }
    pen.finish()
}

fn split(line: &str) -> Vec<&str> {
    let fields: Vec<_> = match line.chars().find(|letter| matches!(letter, ',' | ';' | '\t')) {
        Some(separator) => line.split(separator).collect(),
        None => line.split_whitespace().collect(),
    };
    fields.into_iter().map(|field| field.trim().trim_matches('"')).collect()
}

fn named(fields: &[&str]) -> Result<Columns, String> {
    let place = |name: &str| {
        let place = fields.iter().position(|field| field.eq_ignore_ascii_case(name));
        place.ok_or_else(|| format!("no column has the name {name}"))
    };
    Ok(Columns { places: [place("x")?, place("y")?, place("z")?], are_named: true })
}

fn point(fields: &[&str], columns: Columns) -> Result<[f64; 3], String> {
    if !columns.are_named && fields.len() != 3 {
        return Err(format!("x, y and z are needed; there are {} values", fields.len()));
    }
    let value = |place: usize| {
        let field = fields.get(place).ok_or_else(|| format!("there are only {} values", fields.len()))?;
        field.parse().map_err(|_| format!("`{field}` is not a number"))
    };
    let [x, y, z] = columns.places;
    Ok([value(x)?, value(y)?, value(z)?])
}

#[cfg(test)]
mod tests {
    use super::super::Format::Csv;
    use super::super::format::tests::{error, read};

    #[test]
    fn points_with_and_without_names() {
        for text in [
            "1,2,3\n4,5,6\n",
            "# a comment\r\n1 2 3\r\n4\t5\t6 # another\r\n",
            "Z;speed;\"X\";y\n3;9;1;2\n6;;4;5",
            "x, y, z\n 1 , 2.0, 3e0\n# between\n+4,5.,6",
        ] {
            let points: Vec<_> = read(Csv, text).iter().map(|it| (it.at, it.is_drawing)).collect();
            assert_eq!(points, [([1.0, 2.0, 3.0], false), ([4.0, 5.0, 6.0], true)], "{text}");
        }
    }

    #[test]
    fn an_empty_line_ends_a_stroke() {
        let points = read(Csv, "0,0,0\n1,0,0\n\n2,0,0\n3,0,0\n");
        let drawing: Vec<_> = points.iter().map(|it| (it.is_drawing, it.line)).collect();
        assert_eq!(drawing, [(false, 1), (true, 2), (false, 4), (true, 5)]);
    }

    #[test]
    fn errors_name_the_line() {
        for (text, said) in [
            ("", "there are no points"),
            ("x,y,z\n", "there are no points"),
            ("x,y\n1,2\n", "line 1: no column has the name z"),
            ("1,2,3\n1,2\n", "line 2: x, y and z are needed; there are 2 values"),
            ("1,2,3,4\n", "line 1: x, y and z are needed; there are 4 values"),
            ("z,y,x\n\n1,2\n", "line 3: there are only 2 values"),
            ("1,2,3\n1,zwei,3\n", "line 2: `zwei` is not a number"),
            ("0,1;0,2;0,3\n", "line 1: x, y and z are needed; there are 4 values"),
            ("1,2,inf\n", "line 1: a coordinate is not finite or too large"),
        ] {
            assert_eq!(error(Csv, text), said, "{text:?}");
        }
    }
}
