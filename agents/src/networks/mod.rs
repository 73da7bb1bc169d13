//! Stacks of multilayer perceptrons with their backward pass written out.
//!
//! A [`Stack`] is E networks of one shape in one flat parameter vector: an actor or a critic is a stack of
//! one, an ensemble a stack of several. [`Passes`] runs them forward and backward on buffers that are
//! allocated once; libtorch multiplies the matrices, and everything between two products is one loop over the
//! data ([`kernels`]). Compared with automatic differentiation this saves allocations, page faults and passes
//! over memory, so that a gradient step costs little more than its matrix products.
//!
//! Shapes are written `[E, rows, columns]`; a layer computes rows · weight + bias with weight `[inputs,
//! outputs]`. The last layer's weights and results have few columns and are stored column by column
//! ([`Block::by_columns`]).

mod adam;
mod block;
mod kernels;
mod passes;
mod shape;
mod slices;
mod stack;
mod trained;

#[cfg(test)]
pub(crate) use block::done;
pub(crate) use block::{Block, Views, copy};
pub(crate) use passes::Passes;
pub(crate) use shape::{Output, Shape};
pub(crate) use slices::{read, with_slices};
pub(crate) use stack::Stack;
pub(crate) use trained::{Parameters, SavedStack, Trained};
