//! Small ASCII FBX files of quads with materials and textures.

use super::ascii::header;

/// A file that is being written. Ids are given out in order.
#[derive(Default)]
pub struct Looks {
    templates: String,
    objects: String,
    connections: String,
    last: i64,
}

/// A property of three numbers.
pub fn vector(name: &str, [x, y, z]: [f64; 3]) -> String {
    format!("\t\t\tP: \"{name}\", \"Vector3D\", \"Vector\", \"A\",{x},{y},{z}\n")
}

/// A colour.
pub fn colour(name: &str, [r, g, b]: [f64; 3]) -> String {
    format!("\t\t\tP: \"{name}\", \"Color\", \"\", \"A\",{r},{g},{b}\n")
}

/// A number.
pub fn number(name: &str, value: f64) -> String {
    format!("\t\t\tP: \"{name}\", \"Number\", \"\", \"A\",{value}\n")
}

/// A whole number.
pub fn whole(name: &str, value: i64) -> String {
    format!("\t\t\tP: \"{name}\", \"int\", \"Integer\", \"\",{value}\n")
}

/// A text.
pub fn text(name: &str, value: &str) -> String {
    format!("\t\t\tP: \"{name}\", \"KString\", \"\", \"\",\"{value}\"\n")
}

impl Looks {
    fn id(&mut self) -> i64 {
        self.last += 1;
        1000 + self.last
    }

    /// What materials say that do not say it themselves.
    pub fn template(&mut self, properties: &str) {
        self.templates = format!(
            "Definitions:  {{\n\tVersion: 100\n\tCount: 1\n\tObjectType: \"Material\" {{\n\t\tCount: 1\n\t\t\
             PropertyTemplate: \"FbxSurfacePhong\" {{\n\t\t\tProperties70:  {{\n{properties}\t\t\t}}\n\t\t}}\n\t}}\n}}\n"
        );
    }

    /// A quad that wears `material`. Each of its UV sets has a name and the largest U and V.
    pub fn quad(&mut self, name: &str, sets: &[(&str, f64)], material: i64) {
        let (model, geometry) = (self.id(), self.id());
        let mut layers = String::new();
        let mut elements = String::new();
        for (set, (title, most)) in sets.iter().enumerate() {
            elements += &format!(
                "\t\tLayerElementUV: {set} {{\n\t\t\tVersion: 101\n\t\t\tName: \"{title}\"\n\t\t\t\
                 MappingInformationType: \"ByPolygonVertex\"\n\t\t\tReferenceInformationType: \"Direct\"\n\t\t\t\
                 UV: *8 {{\n\t\t\t\ta: 0,0,{most},0,{most},{most},0,{most}\n\t\t\t}}\n\t\t}}\n"
            );
            layers += &format!(
                "\t\tLayer: {set} {{\n\t\t\tVersion: 100\n\t\t\tLayerElement:  {{\n\t\t\t\t\
                 Type: \"LayerElementUV\"\n\t\t\t\tTypedIndex: {set}\n\t\t\t}}\n\t\t}}\n"
            );
        }
        self.objects += &format!(
            "\tModel: {model}, \"Model::{name}\", \"Mesh\" {{\n\t\tVersion: 232\n\t}}\n\
             \tGeometry: {geometry}, \"Geometry::{name}\", \"Mesh\" {{\n\t\tVertices: *12 {{\n\t\t\t\
             a: -1,-1,0,1,-1,0,1,1,0,-1,1,0\n\t\t}}\n\t\tPolygonVertexIndex: *4 {{\n\t\t\ta: 0,1,2,-4\n\t\t}}\n\t\t\
             GeometryVersion: 124\n{elements}{layers}\t}}\n"
        );
        for (from, to) in [(model, 0), (geometry, model), (material, model)] {
            self.connect(from, to);
        }
    }

    /// A material.
    pub fn material(&mut self, name: &str, shading: &str, properties: &str) -> i64 {
        let id = self.id();
        self.objects += &format!(
            "\tMaterial: {id}, \"Material::{name}\", \"\" {{\n\t\tVersion: 102\n\t\tShadingModel: \"{shading}\"\n\t\t\
             MultiLayer: 0\n\t\tProperties70:  {{\n{properties}\t\t}}\n\t}}\n"
        );
        id
    }

    /// A texture of the picture `file`, as `property` of `material`.
    pub fn texture(&mut self, file: &str, properties: &str, material: i64, property: &str) -> i64 {
        let id = self.id();
        let file = file.replace('\\', "\\\\");
        self.objects += &format!(
            "\tTexture: {id}, \"Texture::t{id}\", \"\" {{\n\t\tType: \"TextureVideoClip\"\n\t\tVersion: 202\n\t\t\
             TextureName: \"Texture::t{id}\"\n\t\tFileName: \"{file}\"\n\t\tRelativeFilename: \"{file}\"\n\t\t\
             Properties70:  {{\n{properties}\t\t}}\n\t}}\n"
        );
        self.property(id, material, property);
        id
    }

    /// An embedded picture, in base 64, of a texture.
    pub fn video(&mut self, file: &str, content: &str, texture: i64) {
        let id = self.id();
        self.objects += &format!(
            "\tVideo: {id}, \"Video::v{id}\", \"Clip\" {{\n\t\tType: \"Clip\"\n\t\tFilename: \"{file}\"\n\t\t\
             RelativeFilename: \"{file}\"\n\t\tContent: ,\n\t\t\t\"{content}\"\n\t}}\n"
        );
        self.connect(id, texture);
    }

    /// A texture of several layers, as `property` of `material`.
    pub fn layered(&mut self, material: i64, property: &str) -> i64 {
        let id = self.id();
        self.objects += &format!(
            "\tLayeredTexture: {id}, \"LayeredTexture::layers{id}\", \"\" {{\n\t\tLayeredTexture: 101\n\t}}\n"
        );
        self.property(id, material, property);
        id
    }

    /// Connects two objects.
    pub fn connect(&mut self, from: i64, to: i64) {
        self.connections += &format!("\tC: \"OO\",{from},{to}\n");
    }

    /// Connects an object to a property of another.
    pub fn property(&mut self, from: i64, to: i64, property: &str) {
        self.connections += &format!("\tC: \"OP\",{from},{to}, \"{property}\"\n");
    }

    /// The file.
    pub fn text(&self) -> String {
        let Self {
            templates,
            objects,
            connections,
            ..
        } = self;
        header()
            + templates
            + "Objects:  {\n"
            + objects
            + "}\nConnections:  {\n"
            + connections
            + "}\n"
    }
}
