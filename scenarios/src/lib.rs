pub mod initial;
