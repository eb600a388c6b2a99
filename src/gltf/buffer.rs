//! The binary chunk and the views and accessors into it.

use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::buffer::{Target, View};
use gltf::json::validation::{Checked, USize64};
use gltf::json::{Accessor, Index, Root, Value};

/// The binary chunk in the making.
pub(super) struct Binary {
    pub(super) bytes: Vec<u8>,
}

/// Elements of an accessor.
pub(super) struct Elements {
    pub(super) component: ComponentType,
    pub(super) shape: Type,
    pub(super) count: usize,
}

impl Binary {
    /// Starts a view on a multiple of four.
    pub(super) fn start(&mut self) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.bytes.len()
    }

    /// Ends the view begun at `start`.
    pub(super) fn view(&self, root: &mut Root, start: usize, target: Option<Target>) -> Index<View> {
        root.push(View {
            buffer: Index::new(0),
            byte_length: USize64::from(self.bytes.len() - start),
            byte_offset: (start > 0).then(|| USize64::from(start)),
            byte_stride: None,
            name: None,
            target: target.map(Checked::Valid),
            extensions: None,
            extras: None,
        })
    }

    /// A view of vertex attributes written by `fill`, and its accessor.
    pub(super) fn attribute(
        &mut self,
        root: &mut Root,
        elements: Elements,
        fill: impl FnOnce(&mut Vec<u8>),
    ) -> Index<Accessor> {
        let start = self.start();
        fill(&mut self.bytes);
        let view = self.view(root, start, Some(Target::ArrayBuffer));
        root.push(accessor(view, 0, elements, None))
    }
}

/// An accessor at an offset into a view, with the least and greatest of each component where demanded.
pub(super) fn accessor(
    view: Index<View>,
    offset: usize,
    elements: Elements,
    bounds: Option<([f32; 3], [f32; 3])>,
) -> Accessor {
    let list = |numbers: [f32; 3]| Value::from(numbers.to_vec());
    Accessor {
        buffer_view: Some(view),
        byte_offset: (offset > 0).then(|| USize64::from(offset)),
        count: USize64::from(elements.count),
        component_type: Checked::Valid(GenericComponentType(elements.component)),
        extensions: None,
        extras: None,
        type_: Checked::Valid(elements.shape),
        min: bounds.map(|(min, _)| list(min)),
        max: bounds.map(|(_, max)| list(max)),
        name: None,
        normalized: false,
        sparse: None,
    }
}
