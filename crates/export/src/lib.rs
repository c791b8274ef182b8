//! [`macro@export`], which exports a function of the C ABI. By hand and not with syn: a cold build of the library is to
//! be cheap, and all that has to be found is where the function's name stands.

use proc_macro::{Delimiter, TokenStream, TokenTree};

/// What every function of the C ABI asks of its caller.
const SAFETY: &str = "\n\n# Safety\n\nPointers, threads and interrupts: the rules of [this crate](crate).";

/// Exports `pub unsafe extern "C" fn name(..)` as the symbol `name`, and adds the contract of the whole C ABI to its
/// documentation.
///
/// `#[export(dp)]`, `#[export(olp)]` and `#[export(gx)]` are for functions whose arguments depend on the sizes of that
/// family: they get a second symbol with these in its name (`dp_recv_128_32`, from the environment variable `DP_SIZES`
/// that the build script sets). Both symbols have the same body, of which the compiler makes one function, so that
/// neither costs a jump.
#[proc_macro_attribute]
pub fn export(family: TokenStream, function: TokenStream) -> TokenStream {
    let tokens: Vec<TokenTree> = function.into_iter().collect();
    exported(&family.to_string(), &tokens)
        .unwrap_or_else(|message| format!("::core::compile_error!({message:?});").parse().unwrap_or_default())
}

fn exported(family: &str, tokens: &[TokenTree]) -> Result<TokenStream, &'static str> {
    if !matches!(family, "" | "dp" | "olp" | "gx") {
        return Err("no family of sizes: dp, olp or gx");
    }
    let is_word = |token: &TokenTree, word: &str| matches!(token, TokenTree::Ident(ident) if ident.to_string() == word);
    let keyword = tokens.iter().position(|token| is_word(token, "fn")).ok_or("not a function")?;
    let (head, function) = tokens.split_at(keyword);
    let Some((TokenTree::Ident(name), signature_and_body)) = function.get(1..).and_then(<[_]>::split_first) else {
        return Err("a function without a name");
    };
    let is_unsafe = head.iter().any(|token| is_word(token, "unsafe"));
    let visibility = head.iter().position(|token| is_word(token, "pub")).ok_or("not public")?;
    let (attributes, qualifiers) = head.split_at(visibility);

    let mut output: TokenStream = attributes.iter().cloned().collect();
    let safety = if is_unsafe { format!("#[doc = {SAFETY:?}]") } else { String::new() };
    output.extend(parse(&format!("{safety} #[unsafe(no_mangle)]"))?);
    output.extend(qualifiers.iter().chain(function).cloned());

    if !family.is_empty() {
        let sizes = family.to_uppercase() + "_SIZES";
        let symbol = format!("::core::concat!(\"{name}_\", ::core::env!(\"{sizes}\"))");
        let qualifiers = if is_unsafe { "unsafe" } else { "" };
        let start =
            format!("#[unsafe(export_name = {symbol})] #[allow(clippy::all)] {qualifiers} extern \"C\" fn sized");
        let mut alias = parse(&start)?;
        alias.extend(signature_and_body.iter().cloned());
        output.extend(parse("const _: () =")?);
        output.extend([TokenTree::Group(proc_macro::Group::new(Delimiter::Brace, alias))]);
        output.extend(parse(";")?);
    }
    Ok(output)
}

fn parse(text: &str) -> Result<TokenStream, &'static str> {
    text.parse().map_err(|_| "not Rust")
}
