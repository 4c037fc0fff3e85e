//! Declaration: the macro that makes a set of its list of columns.

/// Declares a struct of columns and its list in one place.
///
/// ```
/// use nbody::columns;
/// use nbody::points::{Columns, Dimension, Label};
/// columns! {
///     /// Points with a mass.
///     pub struct Masses {
///         /// mass
///         m: Real = Label::snapshot("Masses", Dimension::MASS, "mass"),
///         /// position
///         x: Vector = Label::snapshot("Coordinates", Dimension::LENGTH, "position"),
///     }
/// }
/// let mut set = Masses::default();
/// set.resize(3);
/// assert_eq!(set.len(), 3);
/// assert_eq!(set.list().len(), 2);
/// ```
#[macro_export]
macro_rules! columns {
    (@type Real) => { Vec<f64> };
    (@type Vector) => { Vec<$crate::points::Vec3> };
    (@type Integer) => { Vec<u64> };
    (@type Short) => { Vec<u32> };
    ($(#[$doc:meta])* pub struct $Name:ident { $first:ident : $first_kind:ident = $first_label:expr $(, $(#[$field_doc:meta])* $field:ident : $kind:ident = $label:expr)* $(,)? }) => {
        compile_error!("each column needs a doc line");
    };
    ($(#[$doc:meta])* pub struct $Name:ident {
        $(#[$first_doc:meta])+ $first:ident : $first_kind:ident = $first_label:expr
        $(, $(#[$field_doc:meta])+ $field:ident : $kind:ident = $label:expr)* $(,)?
    }) => {
        $(#[$doc])*
        #[derive(Clone, Debug, Default)]
        pub struct $Name {
            $(#[$first_doc])+
            pub $first: $crate::columns!(@type $first_kind),
            $($(#[$field_doc])+
            pub $field: $crate::columns!(@type $kind),)*
        }

        impl $crate::points::Columns for $Name {
            fn list(&self) -> Vec<($crate::points::Label, $crate::points::ColumnRef<'_>)> {
                vec![
                    ($first_label, $crate::points::ColumnRef::$first_kind(&self.$first)),
                    $(($label, $crate::points::ColumnRef::$kind(&self.$field)),)*
                ]
            }

            fn list_mut(&mut self) -> Vec<($crate::points::Label, $crate::points::ColumnMut<'_>)> {
                vec![
                    ($first_label, $crate::points::ColumnMut::$first_kind(&mut self.$first)),
                    $(($label, $crate::points::ColumnMut::$kind(&mut self.$field)),)*
                ]
            }

            fn len(&self) -> usize {
                self.$first.len()
            }

            fn reserved(&self) -> usize {
                fn bytes<T>(column: &Vec<T>) -> usize {
                    column.capacity() * size_of::<T>()
                }
                bytes(&self.$first) $(+ bytes(&self.$field))*
            }
        }
    };
}
