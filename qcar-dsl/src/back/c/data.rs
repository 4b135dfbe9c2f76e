//! Names, units, values and sparsity as arrays, and the functions that read them.

use qcar_model::{About, Entry};

use super::text::{number, string};

/// The arrays that the header declares; `values` are those of the parameters.
pub fn data(about: &About, values: &[f64]) -> String {
    let model = &about.name;
    let unbounded = (f64::NEG_INFINITY, f64::INFINITY);
    let parameters = about.parameters.iter().zip(values).map(|(p, &value)| {
        let (lower, upper) = p.range.unwrap_or(unbounded);
        let texts = [&p.name, &p.unit, &p.doc].map(|text| string(text)).join(", ");
        format!("{texts}, {}, {}, {}", number(value), number(lower), number(upper))
    });
    let signal = |name: &str, unit: &str| format!("{}, {}", string(name), string(unit));
    let states = about.states.iter().map(|state| signal(&state.name, &state.unit));
    let inputs = about.inputs.iter().map(|input| signal(&input.name, &input.unit));
    let outputs = about.outputs.iter().map(|output| signal(&output.name, &output.unit));
    let sensitivities = about
        .sensitivities
        .iter()
        .map(|(at, p)| format!("{{{}}}, {p}", entry(at)));
    let jacobian = about
        .parameter_jacobian
        .iter()
        .map(|&(y, row, p)| format!("{}, {row}, {p}", u8::from(y)));
    let matrices = about.matrices.iter().map(entry);
    let array = |kind, name, rows, zeros| array(model, kind, name, rows, zeros);
    let parameter = "0, 0, 0, 0.0, 0.0, 0.0";
    [
        array("parameter", "parameter_list", parameters.collect(), parameter),
        array("signal", "state_list", states.collect(), "0, 0"),
        array("signal", "input_list", inputs.collect(), "0, 0"),
        array("signal", "output_list", outputs.collect(), "0, 0"),
        array("entry", "matrices_at", matrices.collect(), "0, 0, 0"),
        array(
            "sensitivity",
            "sensitivities_at",
            sensitivities.collect(),
            "{0, 0, 0}, 0",
        ),
        array(
            "derivative_by_parameter",
            "parameter_jacobian_at",
            jacobian.collect(),
            "0, 0, 0",
        ),
    ]
    .join("\n")
}

/// An array of structs, which ends with one of `zeros`: C has no empty array.
fn array(model: &str, kind: &str, name: &str, rows: Vec<String>, zeros: &str) -> String {
    let rows: String = rows.iter().map(|row| format!("    {{{row}}},\n")).collect();
    format!("const {model}_{kind} {model}_{name}[] = {{\n{rows}    {{{zeros}}}\n}};\n")
}

fn entry(entry: &Entry) -> String {
    format!("'{:?}', {}, {}", entry.matrix, entry.row, entry.column)
}

/// The functions that read the arrays.
pub fn functions(about: &About) -> String {
    let (model, upper) = (&about.name, about.name.to_uppercase());
    let clear = |matrix: &str, rows: &str, columns: &str| {
        format!("    for (i = 0; i < {upper}_{rows} * {upper}_{columns}; i++)\n        {matrix}[i] = 0.0;\n")
    };
    let cleared = [
        clear("a", "STATES", "STATES"),
        clear("b", "STATES", "INPUTS"),
        clear("c", "OUTPUTS", "STATES"),
        clear("d", "OUTPUTS", "INPUTS"),
    ]
    .concat();
    let put = |matrix: &str, columns: &str| {
        format!(
            "        case '{}': {matrix}[at->row * {upper}_{columns} + at->column] = nonzeros[i]; break;\n",
            matrix.to_uppercase()
        )
    };
    let scattered = [
        put("a", "STATES"),
        put("b", "INPUTS"),
        put("c", "STATES"),
        put("d", "INPUTS"),
    ]
    .concat();
    format!(
        "void {model}_defaults(double *p)
{{
    int i;
    for (i = 0; {model}_parameter_list[i].name; i++)
        p[i] = {model}_parameter_list[i].value;
}}

void {model}_state_space(const double *p, const double *x, const double *u, double *a, double *b, double *c, double *d)
{{
    double nonzeros[{upper}_MATRICES + 1];
    int i;
    {model}_matrices(p, x, u, nonzeros);
{cleared}    for (i = 0; i < {upper}_MATRICES; i++) {{
        const {model}_entry *at = &{model}_matrices_at[i];
        switch (at->matrix) {{
{scattered}        default: break;
        }}
    }}
}}
"
    )
}
