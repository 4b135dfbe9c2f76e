//! Names of the results of the programs: entries of matrices, and derivatives by parameters.

use qcar_model::{About, Entry};

/// The name of an entry of a matrix: `A[vz_wheel, z_body]`.
pub fn entry_name(about: &About, entry: &Entry) -> String {
    let (row, column) = about.relates(entry);
    format!("{:?}[{row}, {column}]", entry.matrix)
}

/// `∂A[vz_wheel, z_body]/∂k_tire` for each nonzero.
pub fn sensitivity_names(about: &About) -> Vec<String> {
    let parameter = |place: u16| &about.parameters[place as usize].name;
    let name = |(entry, p): &(Entry, u16)| format!("∂{}/∂{}", entry_name(about, entry), parameter(*p));
    about.sensitivities.iter().map(name).collect()
}

/// `∂(d/dt vz_wheel)/∂k_tire` or `∂z_wheel_acceleration/∂k_tire` for each nonzero.
pub fn parameter_jacobian_names(about: &About) -> Vec<String> {
    let name = |&(is_output, row, parameter): &(bool, u16, u16)| {
        let row = match is_output {
            true => about.outputs[row as usize].name.to_string(),
            false => format!("(d/dt {})", about.states[row as usize].name),
        };
        format!("∂{row}/∂{}", about.parameters[parameter as usize].name)
    };
    about.parameter_jacobian.iter().map(name).collect()
}
