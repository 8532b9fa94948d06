"""The table of looks: colour, roughness and fine relief of each part."""

from dataclasses import dataclass
from typing import Callable, Optional

import clothes
import extremities
import head
import looks_body as body
import looks_clothes as cloth
import looks_pack as gear
import pack
import sdf
from palette import nothing


@dataclass
class Look:
    surface: Callable                 # points, normals -> linear colour (n, 3), roughness (n,)
    height: Callable                  # points -> relief (m)
    field: Optional[Callable] = None  # the body's fine field


LOOKS = {
    "head": Look(body.head_surface, body.head_height, sdf.mirror_field(head.head_fine)),
    "eye": Look(body.eye_surface, nothing),
    "hat": Look(cloth.hat_surface, cloth.hat_height, sdf.mirror_field(head.hat_field)),
    "hand": Look(body.hand_surface, body.hand_height, sdf.mirror_field(extremities.hand_field)),
    "jacket": Look(cloth.jacket_surface, cloth.jacket_height, sdf.mirror_field(clothes.jacket_field)),
    "trousers": Look(cloth.trousers_surface, cloth.trousers_height, sdf.mirror_field(clothes.trousers_field)),
    "boot": Look(cloth.boot_surface, cloth.boot_height, sdf.mirror_field(extremities.boot_field)),
    "pack": Look(gear.pack_surface, gear.pack_height, sdf.mirror_field(pack.body_field)),
    "lid": Look(gear.lid_surface, gear.lid_height, sdf.mirror_field(pack.lid_field)),
    "roll": Look(gear.roll_surface, gear.roll_height, sdf.mirror_field(pack.roll_field)),
    "strap": Look(gear.strap_surface, gear.strap_height),
    "belt": Look(gear.belt_surface, gear.belt_height),
    "collar": Look(cloth.collar_surface, cloth.collar_height),
}
