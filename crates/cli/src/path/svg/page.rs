//! The page of a drawing: what its coordinates are in millimetres.

use kurbo::{Affine, Vec2};
use roxmltree::Node;
use svgtypes::{Align, AspectRatio, ViewBox};

use super::length;

const MM_PER_PIXEL: f64 = 25.4 / 96.0;

/// From the drawing's coordinates to millimetres, x to the right and y up from the lower left corner; where no height is
/// given, from the coordinates' origin.
pub(super) fn to_page(root: &Node) -> Result<Affine, String> {
    let side = |name| match root.attribute(name) {
        // That of a window, which is not known.
        Some(text) if text.trim_end().ends_with('%') || text == "auto" => Ok(None),
        _ => length(root, name),
    };
    let (width, height) = (side("width")?, side("height")?);
    if [width, height].iter().flatten().any(|side| *side <= 0.0) {
        return Err("the drawing's width and height must be above zero".into());
    }
    let view: Option<ViewBox> = match root.attribute("viewBox") {
        Some(text) => Some(text.parse().map_err(|error| format!("{error}"))?),
        None => None,
    };
    let (to_pixels, height) = match view {
        None => (Affine::IDENTITY, height.unwrap_or_default()),
        Some(view) => {
            // Of the sides, one that is not given keeps the ratio.
            let [width, height] = match (width, height) {
                (None, None) => [view.w, view.h],
                (Some(width), None) => [width, width / view.w * view.h],
                (None, Some(height)) => [height / view.h * view.w, height],
                (Some(width), Some(height)) => [width, height],
            };
            let ratio = root.attribute("preserveAspectRatio").unwrap_or("xMidYMid").parse();
            let ratio: AspectRatio = ratio.map_err(|error| format!("preserveAspectRatio: {error}"))?;
            (fit(view, width, height, ratio), height)
        }
    };
    let upright = Affine::translate((0.0, height)) * Affine::FLIP_Y;
    Ok(Affine::scale(MM_PER_PIXEL) * upright * to_pixels)
}

/// The view box, fitted into the page.
fn fit(view: ViewBox, width: f64, height: f64, ratio: AspectRatio) -> Affine {
    let (x, y) = (width / view.w, height / view.h);
    let (x, y) = match ratio {
        AspectRatio { align: Align::None, .. } => (x, y),
        AspectRatio { slice: true, .. } => (x.max(y), x.max(y)),
        AspectRatio { slice: false, .. } => (x.min(y), x.min(y)),
    };
    // How much of what is left over is on the left, and above.
    let left = match ratio.align {
        Align::None | Align::XMinYMin | Align::XMinYMid | Align::XMinYMax => 0.0,
        Align::XMidYMin | Align::XMidYMid | Align::XMidYMax => 0.5,
        Align::XMaxYMin | Align::XMaxYMid | Align::XMaxYMax => 1.0,
    };
    let above = match ratio.align {
        Align::None | Align::XMinYMin | Align::XMidYMin | Align::XMaxYMin => 0.0,
        Align::XMinYMid | Align::XMidYMid | Align::XMaxYMid => 0.5,
        Align::XMinYMax | Align::XMidYMax | Align::XMaxYMax => 1.0,
    };
    let shift = Vec2::new((width - view.w * x) * left, (height - view.h * y) * above);
    Affine::translate(shift) * Affine::scale_non_uniform(x, y) * Affine::translate((-view.x, -view.y))
}
