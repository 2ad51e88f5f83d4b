// What the numbers of the page mean, and in which unit.

export const GLOSSARY: Readonly<Record<string, string>> = {
  "tip": "place of the end of the backbone in the world, in mm",
  "orientation": "how the cross-section at the tip is turned, as a quaternion (w, x, y, z)",
  "residual": "what is left of the equations of equilibrium, relative to their scale: a number without unit",
  "solve time": "time that the model took for this shape, and the iterations of Newton's method",
  "stability": "least eigenvalue of the tangent stiffness relative to that of the backbone alone: below 0 the shape is left at the slightest disturbance",
  "driven by": "the model whose cable lengths this one takes, because it knows no tensions",
  "touches": "places where the robot touches obstacles, and the sum of their normal forces in N",
  "compliance": "how far a force of 1 N moves the tip along the axes of the ellipsoid, in mm/N",
  "stiffness": "force that moves the tip by 1 mm along the axes of the ellipsoid, in N/mm",
  "tension in N": "force in the cable behind the base; slack where it hangs loose",
  "length in mm": "length of the path of the cable inside the robot",
  "shortening in mm": "length of that path before actuation, less the present one",
  "holds": "torque or force that the motor holds, from the tensions of its cables",
  "of its limit": "the same in per cent of what the motor can hold",
};
