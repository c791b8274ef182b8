//! Checks answers against the OpenAPI description: as much of JSON Schema as it uses, and an error where it uses more.

use std::sync::LazyLock;

use serde_json::Value;

/// What the program says it answers.
static OPENAPI: LazyLock<Value> =
    LazyLock::new(|| serde_json::from_str(include_str!("../../crates/serve/openapi.json")).unwrap());

/// Asserts that this is described as an answer.
pub(super) fn check_answer(method: &str, path: &str, status: u16, kind: &str, body: &[u8]) {
    let path = path.split('?').next().unwrap();
    let paths = OPENAPI["paths"].as_object().unwrap();
    let found = paths.iter().find(|(template, _)| {
        let (mut parts, mut described) = (path.split('/'), template.split('/'));
        let same =
            described.by_ref().zip(parts.by_ref()).all(|(described, part)| described == "{name}" || described == part);
        same && path.split('/').count() == template.split('/').count()
    });
    let answer = found.map(|(_, item)| &item[method.to_ascii_lowercase()]["responses"][status.to_string()]);
    let Some(answer) = answer.filter(|answer| answer.is_object()) else {
        // What is not described can only be a problem.
        assert!(matches!(status, 404 | 405), "{method} {path}: {status} is not described");
        let problem: Value = serde_json::from_slice(body).unwrap();
        return check("Problem", &problem);
    };
    let Some(content) = answer.get("content") else { return assert!(body.is_empty(), "{method} {path}") };
    let schema = &content[kind]["schema"];
    assert!(schema.is_object(), "{method} {path}: {kind} is not described");
    let value = serde_json::from_slice(body).unwrap_or_else(|error| panic!("{method} {path}: {error}"));
    validate(schema, &value).unwrap_or_else(|error| panic!("{method} {path} {status}: {error}\n{value:#}"));
}

/// Asserts that this is one of those that are described by this name.
pub(super) fn check(name: &str, value: &Value) {
    let schema = &OPENAPI["components"]["schemas"][name];
    validate(schema, value).unwrap_or_else(|error| panic!("{name}: {error}\n{value:#}"));
}

fn validate(schema: &Value, value: &Value) -> Result<(), String> {
    let wrong = |what: &str| Err(format!("{what}: {value} by {schema}"));
    for (keyword, wanted) in schema.as_object().ok_or("no schema")? {
        let is_met = match keyword.as_str() {
            "description" | "additionalProperties" => true,
            "$ref" => {
                let name = wanted.as_str().unwrap().strip_prefix("#/components/schemas/").unwrap();
                validate(&OPENAPI["components"]["schemas"][name], value)?;
                true
            }
            "oneOf" => {
                let results: Vec<_> = wanted.as_array().unwrap().iter().map(|one| validate(one, value)).collect();
                let count = results.iter().filter(|result| result.is_ok()).count();
                if count != 1 {
                    return Err(format!("{count} of oneOf: {results:?}"));
                }
                true
            }
            "const" => value == wanted,
            "enum" => wanted.as_array().unwrap().contains(value),
            "type" => match wanted {
                Value::Array(kinds) => kinds.iter().any(|kind| is_of(kind, value)),
                kind => is_of(kind, value),
            },
            "properties" => {
                let (wanted, is_closed) =
                    (wanted.as_object().unwrap(), schema["additionalProperties"] == Value::Bool(false));
                for (name, value) in value.as_object().into_iter().flatten() {
                    match wanted.get(name) {
                        Some(schema) => validate(schema, value).map_err(|error| format!("{name}: {error}"))?,
                        None if is_closed => return wrong(&format!("{name} is unknown")),
                        None => (),
                    }
                }
                true
            }
            "required" => value.as_object().is_none_or(|object| {
                wanted.as_array().unwrap().iter().all(|name| object.contains_key(name.as_str().unwrap()))
            }),
            "items" => {
                value.as_array().into_iter().flatten().try_for_each(|item| validate(wanted, item))?;
                true
            }
            "minItems" => value.as_array().is_none_or(|array| array.len() as u64 >= wanted.as_u64().unwrap()),
            "maxItems" => value.as_array().is_none_or(|array| array.len() as u64 <= wanted.as_u64().unwrap()),
            "minimum" => value.as_f64().is_none_or(|number| number >= wanted.as_f64().unwrap()),
            "maximum" => value.as_f64().is_none_or(|number| number <= wanted.as_f64().unwrap()),
            _ => return Err(format!("{keyword} can't be checked")),
        };
        if !is_met {
            return wrong(keyword);
        }
    }
    Ok(())
}

fn is_of(kind: &Value, value: &Value) -> bool {
    match kind.as_str().unwrap() {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_u64() || value.is_i64(),
        "number" => value.is_number(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        _ => false,
    }
}

#[test]
fn what_is_not_as_described_is_noticed() {
    let problem = serde_json::json!({ "type": "a", "title": "b", "status": 400, "detail": "c" });
    let schema = &OPENAPI["components"]["schemas"]["Problem"];
    assert!(validate(schema, &problem).is_ok());
    for (name, value) in [("status", Value::from("400")), ("status", Value::from(-1)), ("more", Value::Null)] {
        let mut other = problem.clone();
        other[name] = value;
        assert!(validate(schema, &other).is_err(), "{other}");
    }
    let vector = &OPENAPI["components"]["schemas"]["Vector"];
    assert!(validate(vector, &serde_json::json!([1, 2.5, -3])).is_ok());
    assert!(validate(vector, &serde_json::json!([1, 2])).is_err());
}
