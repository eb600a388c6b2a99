//! The macros that declare what a document may say.
//!
//! One declaration of a table gives its Rust type, its reader, its JSON Schema and its section of the
//! reference page. Doc comments are for the artist who writes the document.

/// Declares a table, `"title in messages" pub Name`: `field: Type = default => check;`. A field without a default must be written unless
/// its type says what its absence means ([`Option`]). A `check` is a [`Check`](super::check::Check). After
/// the fields, `checked` names a method `fn(&self, Span, &mut Reader) -> bool` that looks at all of them.
macro_rules! table {
    (
        $(#[doc = $doc:literal])+
        $title:literal $vis:vis $name:ident {
            $($(#[doc = $field_doc:literal])+ $field:ident: $type:ty $(= $default:expr)? $(=> $check:expr)?;)*
        }
        $(checked $checked:ident)?
    ) => {
        $(#[doc = $doc])+
        #[derive(Clone, Debug, PartialEq)]
        $vis struct $name {$(
            $(#[doc = $field_doc])+
            $vis $field: $type,
        )*}

        impl $name {
            /// Reads these fields of a table that may have others.
            pub(crate) fn take(
                fields: &mut $crate::language::spec::reader::Fields<'_>,
                reader: &mut $crate::language::spec::reader::Reader<'_>,
            ) -> Option<Self> {
                $(let $field = fields.take::<$type>(
                    stringify!($field),
                    $crate::language::spec::construct::optional!($(|| <$type>::from($default))?),
                    $crate::language::spec::construct::check!($($check)?),
                    reader,
                );)*
                let read = Self { $($field: $field?,)* };
                $(if !read.$checked(fields.span(), reader) {
                    return None;
                })?
                Some(read)
            }

            /// Adds these fields to the schema of a table.
            pub(crate) fn describe(
                object: &mut $crate::language::spec::schema::Object,
                schemas: &mut $crate::language::spec::schema::Schemas,
            ) {
                $(object.field::<$type>(
                    stringify!($field),
                    concat!($($field_doc, "\n"),+),
                    $crate::language::spec::construct::optional!($(|| <$type>::from($default))?),
                    $crate::language::spec::construct::check!($($check)?),
                    schemas,
                );)*
            }
        }

        impl $crate::language::spec::reader::Read for $name {
            fn read(
                value: &$crate::language::value::Value,
                reader: &mut $crate::language::spec::reader::Reader<'_>,
            ) -> Option<Self> {
                let mut fields = $crate::language::spec::reader::Fields::open(value, $title, reader)?;
                let read = Self::take(&mut fields, reader);
                if fields.close(reader) { read } else { None }
            }

            fn schema(schemas: &mut $crate::language::spec::schema::Schemas) -> serde_json::Value {
                schemas.object($title, concat!($($doc, "\n"),+), Self::describe)
            }
        }
    };
}

/// Declares the kinds of a family: `Variant(Type) = "name"`, of which a table has exactly one.
macro_rules! kinds {
    (
        $(#[doc = $doc:literal])+
        $title:literal $name:ident {
            $($(#[doc = $kind_doc:literal])+ $kind:ident($type:ty) = $text:literal;)+
        }
    ) => {
        $(#[doc = $doc])+
        #[derive(Clone, Debug, PartialEq)]
        pub enum $name {$(
            $(#[doc = $kind_doc])+
            $kind($type),
        )+}

        impl $name {
            /// The kind as a document names it.
            #[must_use]
            pub fn kind(&self) -> &'static str {
                match self {$( Self::$kind(_) => $text, )+}
            }
        }

        impl $crate::language::spec::kind::Kinds for $name {
            const TITLE: &'static str = $title;
            const NAMES: &'static [&'static str] = &[$($text),+];

            fn read_kind(
                name: &str,
                value: &$crate::language::value::Value,
                reader: &mut $crate::language::spec::reader::Reader<'_>,
            ) -> Option<Self> {
                match name {
                    $($text => <$type as $crate::language::spec::reader::Read>::read(value, reader).map(Self::$kind),)+
                    _ => None,
                }
            }

            fn describe_kinds(
                object: &mut $crate::language::spec::schema::Object,
                schemas: &mut $crate::language::spec::schema::Schemas,
            ) {
                $(object.kind::<$type>($text, concat!($($kind_doc, "\n"),+), schemas);)+
            }
        }
    };
}

/// Declares a choice among words: `Variant = "word"`.
macro_rules! choices {
    (
        $(#[doc = $doc:literal])+
        $name:ident {
            $($(#[doc = $choice_doc:literal])+ $choice:ident = $text:literal;)+
        }
    ) => {
        $(#[doc = $doc])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name {$(
            $(#[doc = $choice_doc])+
            $choice,
        )+}

        impl $name {
            /// All of them, in the order of the reference.
            pub const ALL: [Self; [$($text),+].len()] = [$( Self::$choice ),+];

            /// The choice of a word.
            #[must_use]
            pub fn named(word: &str) -> Option<Self> {
                Self::ALL.into_iter().find(|one| one.text() == word)
            }

            /// The word of a document.
            #[must_use]
            pub const fn text(self) -> &'static str {
                match self {$( Self::$choice => $text, )+}
            }
        }

        impl $crate::language::spec::reader::Read for $name {
            fn read(
                value: &$crate::language::value::Value,
                reader: &mut $crate::language::spec::reader::Reader<'_>,
            ) -> Option<Self> {
                let word = $crate::language::spec::kind::choice(value, &[$($text),+], reader)?;
                match word {
                    $($text => Some(Self::$choice),)+
                    _ => None,
                }
            }

            fn schema(_: &mut $crate::language::spec::schema::Schemas) -> serde_json::Value {
                $crate::language::spec::schema::words(&[$(($text, concat!($($choice_doc, "\n"),+)),)+])
            }

            fn written(&self) -> Option<serde_json::Value> {
                Some(serde_json::Value::from(self.text()))
            }
        }
    };
}

/// `Some(value)`, or `None` of nothing.
macro_rules! optional {
    () => {
        None
    };
    ($value:expr) => {
        Some($value)
    };
}

/// The check, or [`Check::ANY`](super::check::Check::ANY) of nothing.
macro_rules! check {
    () => {
        $crate::language::spec::check::Check::ANY
    };
    ($check:expr) => {
        $check
    };
}

pub(crate) use {check, choices, kinds, optional, table};
