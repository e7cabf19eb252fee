//! Initialization: every connected input gets its first value in dependency order, and loops are
//! solved.

use super::error::MasterError;
use super::graph;
use super::solve::{IterationLimits, SolveError, Solved, solve};
use super::system::{ExchangeSide, NumberPath, System};
use super::values::{carried, is_float, number_of, told};
use octant_fmu_host::description::{Causality, Description, Initial};
use octant_fmu_host::instance::{Instance, InstanceError, VariableGroup};
use std::collections::BTreeMap;

/// Loop that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Loop {
    /// Variables of the loop in its order, by their names in the system.
    pub variables: Vec<String>,
    /// Solution.
    pub solved: Solved,
}

/// Side of an FMU.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Of {
    Input,
    Fixed,
    Output,
}

/// A variable of an FMU in the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Vertex {
    node: usize,
    of: Of,
    /// Index in the list of the side.
    at: usize,
}

/// Computes the first values of all FMUs.
pub(super) struct Initializer<'a> {
    pub(super) system: &'a System,
    pub(super) instances: &'a mut [Box<dyn Instance>],
    /// Numbers of each side of each FMU.
    pub(super) inputs: &'a mut [Vec<f64>],
    pub(super) outputs: &'a mut [Vec<f64>],
    pub(super) start_s: f64,
}

/// Wire with its ends in the graph.
struct Link<'a> {
    wire: &'a NumberPath,
    from: Vertex,
    to: Vertex,
}

impl Initializer<'_> {
    /// Gives every connected input its first value. All FMUs are in initialization mode.
    pub(super) fn run(mut self, limits: &IterationLimits) -> Result<Vec<Loop>, MasterError> {
        let system = self.system;
        let vertices = vertices(system);
        let number: BTreeMap<Vertex, usize> =
            vertices.iter().enumerate().map(|(number, vertex)| (*vertex, number)).collect();
        let links = links(system);
        let mut after = vec![Vec::new(); vertices.len()];
        for link in &links {
            after[number[&link.from]].push(number[&link.to]);
        }
        for (output, vertex) in vertices.iter().enumerate() {
            if vertex.of == Of::Output {
                for input in self.needed_by(*vertex, &vertices) {
                    after[number[&input]].push(output);
                }
            }
        }
        after.iter_mut().for_each(|list| {
            list.sort_unstable();
            list.dedup();
        });
        let mut fixed: Vec<Vec<f64>> =
            system.nodes.iter().map(|node| vec![0.0; node.fixed.plan.elements]).collect();
        self.present_values(&mut fixed)?;
        let mut loops = Vec::new();
        for component in graph::components(&after) {
            let members: Vec<Vertex> = component.iter().map(|at| vertices[*at]).collect();
            if graph::is_loop(&component, &after) {
                loops.push(self.solve(&members, &links, &mut fixed, limits)?);
                continue;
            }
            for vertex in members {
                if vertex.of != Of::Output {
                    for link in links.iter().filter(|link| link.to == vertex) {
                        self.carry(link, &mut fixed)?;
                    }
                }
                self.exchange(vertex, &fixed)?;
            }
        }
        Ok(loops)
    }

    fn instance_error(&self, node: usize, error: InstanceError) -> MasterError {
        let node = self.system.nodes[node].name.clone();
        MasterError::Instance { node, time_s: self.start_s, error }
    }

    /// Returns the inputs of an FMU on which an output depends during initialization.
    fn needed_by(&self, output: Vertex, vertices: &[Vertex]) -> Vec<Vertex> {
        let description = self.instances[output.node].description();
        let node = &self.system.nodes[output.node];
        let depends_on = dependencies(description, node.outputs.variables[output.at]);
        let inputs = vertices.iter().filter(|v| v.node == output.node && v.of != Of::Output);
        let needed = inputs.filter(|vertex| {
            let side = self.side(**vertex);
            let reference = description.variables[side.variables[vertex.at]].reference;
            depends_on.as_ref().is_none_or(|list| list.contains(&reference))
        });
        needed.copied().collect()
    }

    fn side(&self, vertex: Vertex) -> &ExchangeSide {
        side(self.system, vertex)
    }

    /// Reads the present values of the inputs: unconnected inputs keep them, and loops start from
    /// them.
    fn present_values(&mut self, fixed: &mut [Vec<f64>]) -> Result<(), MasterError> {
        for (number, node) in self.system.nodes.iter().enumerate() {
            for (side, values) in
                [(&node.inputs, &mut self.inputs[number]), (&node.fixed, &mut fixed[number])]
            {
                let mut rest = values.as_mut_slice();
                for group in &side.plan.groups {
                    let (these, others) = rest.split_at_mut(group.elements);
                    self.instances[number].get(group, these).map_err(|error| {
                        MasterError::Instance {
                            node: node.name.clone(),
                            time_s: self.start_s,
                            error,
                        }
                    })?;
                    rest = others;
                }
            }
        }
        Ok(())
    }

    /// Passes a value along a wire.
    fn carry(&mut self, link: &Link<'_>, fixed: &mut [Vec<f64>]) -> Result<(), MasterError> {
        let wire = link.wire;
        let value = self.outputs[wire.from.node][wire.from.place];
        let converted = wire.convert(value, self.start_s)?;
        match link.to.of {
            Of::Fixed => fixed[wire.to.node][wire.to.place] = converted,
            _ => self.inputs[wire.to.node][wire.to.place] = converted,
        }
        Ok(())
    }

    /// Sets the variable of an input, or reads that of an output.
    fn exchange(&mut self, vertex: Vertex, fixed: &[Vec<f64>]) -> Result<(), MasterError> {
        let side = side(self.system, vertex);
        let range = side.plan.places[vertex.at].clone();
        let instance = &mut self.instances[vertex.node];
        let description = instance.description();
        let variable = &description.variables[side.variables[vertex.at]];
        let group = VariableGroup::of(description, variable).map(VariableGroup::exactly);
        let result = group.and_then(|group| match vertex.of {
            Of::Output => instance.get(&group, &mut self.outputs[vertex.node][range]),
            Of::Input => instance.set(&group, &self.inputs[vertex.node][range]),
            Of::Fixed => instance.set(&group, &fixed[vertex.node][range]),
        });
        result.map_err(|error| self.instance_error(vertex.node, error))
    }

    /// Solves a loop.
    fn solve(
        &mut self,
        members: &[Vertex],
        links: &[Link<'_>],
        fixed: &mut [Vec<f64>],
        limits: &IterationLimits,
    ) -> Result<Loop, MasterError> {
        // Values from outside the loop are known already.
        let mut inside: Vec<&Link<'_>> = Vec::new();
        for link in links.iter().filter(|link| members.contains(&link.to)) {
            if members.contains(&link.from) {
                inside.push(link);
            } else {
                self.carry(link, fixed)?;
            }
        }
        let variables = around(members, &inside, self.system);
        let continuous = inside.iter().all(|link| {
            let nodes = &self.system.nodes;
            let side = &nodes[link.from.node].outputs;
            let from = self.instances[link.from.node].description();
            is_float(from.variables[side.variables[link.from.at]].kind)
                && is_float(link.wire.conversion.kind())
        });
        let nominal: Vec<f64> = inside.iter().map(|link| self.nominal(link)).collect();
        let at = |inputs: &[Vec<f64>], fixed: &[Vec<f64>], link: &Link<'_>| match link.to.of {
            Of::Fixed => fixed[link.wire.to.node][link.wire.to.place],
            _ => inputs[link.wire.to.node][link.wire.to.place],
        };
        let start_s = self.start_s;
        // The solution calculates with numbers.
        let number = |link: &Link<'_>, value: f64| {
            let kind = link.wire.conversion.kind();
            number_of(kind, value).ok_or_else(|| link.wire.misfit(value, start_s))
        };
        let u = inside.iter().map(|link| number(link, at(self.inputs, fixed, link)));
        let mut u: Vec<f64> = u.collect::<Result<_, _>>()?;
        let solved = solve(&mut u, &nominal, continuous, limits, |u, back| {
            self.around_once(members, &inside, fixed, u)?;
            for (link, back) in inside.iter().zip(back) {
                let value = self.outputs[link.wire.from.node][link.wire.from.place];
                *back = number(link, link.wire.convert(value, self.start_s)?)?;
            }
            Ok::<(), MasterError>(())
        })
        .map_err(|error: SolveError<MasterError>| MasterError::of_loop(variables.clone(), error))?;
        // The last evaluation may have been at another point.
        self.around_once(members, &inside, fixed, &u)?;
        Ok(Loop { variables, solved })
    }

    fn around_once(
        &mut self,
        members: &[Vertex],
        inside: &[&Link<'_>],
        fixed: &mut [Vec<f64>],
        u: &[f64],
    ) -> Result<(), MasterError> {
        for (link, number) in inside.iter().zip(u) {
            let value = carried(link.wire.conversion.kind(), *number);
            let value = value.ok_or_else(|| link.wire.misfit(*number, self.start_s))?;
            match link.to.of {
                Of::Fixed => fixed[link.wire.to.node][link.wire.to.place] = value,
                _ => self.inputs[link.wire.to.node][link.wire.to.place] = value,
            }
        }
        let inputs = members.iter().filter(|vertex| vertex.of != Of::Output);
        let outputs = members.iter().filter(|vertex| vertex.of == Of::Output);
        for vertex in inputs.chain(outputs) {
            self.exchange(*vertex, fixed)?;
        }
        Ok(())
    }

    /// Returns the nominal value of a wire's input.
    fn nominal(&self, link: &Link<'_>) -> f64 {
        let description = self.instances[link.to.node].description();
        let variable = &description.variables[self.side(link.to).variables[link.to.at]];
        variable.nominal.filter(|n| n.is_finite() && *n != 0.0).map_or(1.0, f64::abs)
    }
}

impl NumberPath {
    /// Returns the value at the end of the wire.
    #[inline]
    pub(super) fn convert(&self, value: f64, time_s: f64) -> Result<f64, MasterError> {
        self.conversion.carry(value).ok_or_else(|| self.misfit(value, time_s))
    }

    /// Error for a value on which faults can't act.
    #[cold]
    pub(super) fn beyond_faults(&self, value: f64, time_s: f64) -> MasterError {
        MasterError::Value {
            source_name: self.source.clone(),
            target: self.target.clone(),
            value: told(self.conversion.kind(), value),
            time_s,
            reason: "faults act on whole numbers up to 2^53 alone".to_owned(),
        }
    }

    #[cold]
    pub(super) fn misfit(&self, value: f64, time_s: f64) -> MasterError {
        MasterError::Value {
            source_name: self.source.clone(),
            target: self.target.clone(),
            value: self.conversion.told(value),
            time_s,
            reason: self.conversion.misfit(value),
        }
    }
}

fn side(system: &System, vertex: Vertex) -> &ExchangeSide {
    let node = &system.nodes[vertex.node];
    match vertex.of {
        Of::Input => &node.inputs,
        Of::Fixed => &node.fixed,
        Of::Output => &node.outputs,
    }
}

fn vertices(system: &System) -> Vec<Vertex> {
    let mut all = Vec::new();
    for (number, node) in system.nodes.iter().enumerate() {
        for (of, side) in
            [(Of::Input, &node.inputs), (Of::Fixed, &node.fixed), (Of::Output, &node.outputs)]
        {
            all.extend((0..side.variables.len()).map(|at| Vertex { node: number, of, at }));
        }
    }
    all
}

/// Lists all wires with their ends in the graph.
fn links<'a>(system: &'a System) -> Vec<Link<'a>> {
    let holds = |side: &ExchangeSide, place: usize| {
        side.plan.places.iter().position(|range| range.contains(&place)).unwrap_or(0)
    };
    let link = |wire: &'a NumberPath, of| {
        let NumberPath { from, to, .. } = wire;
        let at = holds(&system.nodes[from.node].outputs, from.place);
        let from = Vertex { node: from.node, of: Of::Output, at };
        let into = side(system, Vertex { node: to.node, of, at: 0 });
        Link { wire, from, to: Vertex { node: to.node, of, at: holds(into, to.place) } }
    };
    let inputs = system.wires.iter().map(|wire| link(wire, Of::Input));
    inputs.chain(system.fixed.iter().map(|wire| link(wire, Of::Fixed))).collect()
}

/// Returns the value references on which a variable depends during initialization; `None`: the
/// description doesn't say, so it depends on all.
fn dependencies(description: &Description, number: usize) -> Option<Vec<u32>> {
    let variable = &description.variables[number];
    let of = |list: &[octant_fmu_host::description::ModelUnknown]| {
        list.iter().find(|unknown| unknown.reference == variable.reference).cloned()
    };
    if let Some(unknown) = of(&description.structure.initial_unknowns) {
        return unknown.depends_on;
    }
    // A variable whose start value is given isn't calculated.
    let given = variable.initial == Some(Initial::Exact);
    if given || variable.causality == Causality::Parameter {
        return Some(Vec::new());
    }
    of(&description.structure.outputs).and_then(|unknown| unknown.depends_on)
}

/// Names the variables of a loop, in the order of one way around.
fn around(members: &[Vertex], inside: &[&Link<'_>], system: &System) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    let mut left: Vec<&&Link<'_>> = inside.iter().collect();
    let mut next = left.first().map(|link| link.from.node);
    // Follows the wires from node to node until all are named.
    while !left.is_empty() {
        let at = left.iter().position(|link| Some(link.from.node) == next).unwrap_or(0);
        let link = left.remove(at);
        names.push(link.wire.source.clone());
        names.push(link.wire.target.clone());
        next = Some(link.to.node);
    }
    if names.is_empty() {
        names = members.iter().map(|vertex| system.nodes[vertex.node].name.clone()).collect();
    }
    names
}
