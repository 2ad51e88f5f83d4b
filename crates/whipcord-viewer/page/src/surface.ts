// How bodies look. Without a graphics card their light is that of a matt surface, which takes a fraction of the time.

import { MeshLambertMaterial, MeshStandardMaterial, type MeshStandardMaterialParameters } from "three";

import { drawsBySoftware } from "./sharpness";

export type Surface = MeshStandardMaterial | MeshLambertMaterial;

export function surface(options: MeshStandardMaterialParameters): Surface {
  if (!drawsBySoftware()) return new MeshStandardMaterial(options);
  const { roughness, metalness, ...others } = options;
  void roughness;
  void metalness;
  return new MeshLambertMaterial(others);
}

/** The same as other programs know it. */
export function standard(material: Surface): MeshStandardMaterial {
  if (material instanceof MeshStandardMaterial) return material;
  const { color, vertexColors, transparent, opacity, side } = material;
  return new MeshStandardMaterial({ color, vertexColors, transparent, opacity, side, roughness: 0.6, metalness: 0.05 });
}
