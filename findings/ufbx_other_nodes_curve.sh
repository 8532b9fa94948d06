#!/usr/bin/env bash
# ufbx, by the crate `ufbx`: whose curves it plays where clips move different properties of a node.
#
# Version: ufbx 0.11.5 (crates.io), rustc 1.95.0, Linux x86_64
# Guess:   clip s0 moves rotation and translation of node a; clip s1 moves rotation of a and translation of b. In s1 node a
#          keeps the translation that it has at rest (1, 0, 0), and b goes to (0, 0, 20).
# Seen:    `s1: a at 0 0 20, b at 0 0 20`. In s1 node a is where b goes: walking the properties that the layer moves, ufbx
#          compares their names and not whose they are, so that the next node's first property of that name is taken. That
#          is so only where another clip (or layer) moves the missing property of a.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

# curve_node ID KIND X Y Z: a curve node with one constant curve for each axis.
nodes='' links=''
next=100
curve_node() {
  local id=$1 kind=$2 axis value curve
  shift 2
  nodes+="  AnimationCurveNode: $id, \"AnimCurveNode::$kind\", \"\" { }"$'\n'
  for axis in X Y Z; do
    value=$1
    shift
    printf -v curve '  AnimationCurve: %s, "AnimCurve::", "" {\n    KeyTime: *2 { a: 0,92372316000 }
    KeyValueFloat: *2 { a: %s,%s }\n    KeyAttrFlags: *1 { a: 4 }\n    KeyAttrDataFloat: *4 { a: 0,0,0,0 }
    KeyAttrRefCount: *1 { a: 2 }\n  }\n' "$next" "$value" "$value"
    nodes+=$curve
    links+="  C: \"OP\",$next,$id,\"d|$axis\""$'\n'
    next=$((next + 1))
  done
}
# moves LAYER ID NODE PROPERTY KIND X Y Z
moves() {
  curve_node "$2" "$5" "$6" "$7" "$8"
  links+="  C: \"OO\",$2,$1"$'\n'"  C: \"OP\",$2,$3,\"$4\""$'\n'
}
moves 31 41 11 'Lcl Rotation' R 0 0 90
moves 31 42 11 'Lcl Translation' T 5 0 0
moves 32 43 11 'Lcl Rotation' R 0 0 45
moves 32 44 12 'Lcl Translation' T 0 0 20

model() {
  printf '  Model: %s, "Model::%s", "Null" {\n    Properties70: {\n' "$1" "$2"
  printf '      P: "Lcl Translation", "Lcl Translation", "", "A",%s,0,0\n    }\n  }\n' "$3"
}
stack() {
  printf '  AnimationStack: %s, "AnimStack::%s", "" { Properties70: {\n' "$1" "$2"
  printf '      P: "LocalStop", "KTime", "Time", "",92372316000\n  } }\n  AnimationLayer: %s, "AnimLayer::%s", "" { }\n' "$3" "$2"
}
{
  printf '; FBX 7.4.0 project file\nFBXHeaderExtension: {\n  FBXHeaderVersion: 1003\n  FBXVersion: 7400\n}\nObjects: {\n'
  model 11 a 1
  model 12 b 2
  stack 21 s0 31
  stack 22 s1 32
  printf '%s}\nConnections: {\n  C: "OO",11,0\n  C: "OO",12,0\n  C: "OO",31,21\n  C: "OO",32,22\n%s}\n' "$nodes" "$links"
} >two.fbx

cargo init --quiet --vcs none --name two .
cargo add --quiet ufbx@=0.11.5
cat >src/main.rs <<'RUST'
fn main() {
    let scene = ufbx::load_file("two.fbx", ufbx::LoadOpts::default()).expect("a sound file");
    for stack in &scene.anim_stacks {
        let at = |name: &str| {
            let node = scene.find_node(name).expect("it is there");
            let t = ufbx::evaluate_transform(&stack.anim, node, 1.0).translation;
            format!("{name} at {} {} {}", t.x, t.y, t.z)
        };
        println!("{}: {}, {}", stack.element.name, at("a"), at("b"));
    }
}
RUST
seen=$(cargo run --quiet)
echo "$seen"
[[ $seen == *'s0: a at 5 0 0, b at 2 0 0'* && $seen == *'s1: a at 0 0 20, b at 0 0 20'* ]]
