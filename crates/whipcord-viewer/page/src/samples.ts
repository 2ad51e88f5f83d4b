// Written by the test `samples` of the crate, with UPDATE_SAMPLES=1: what page and server say to each other.

import type { FromPage, ToPage } from "./protocol";

export const fromPage: FromPage[] = [
  {
    "type": "solve",
    "id": 7,
    "commands": [
      {
        "tension": 1.5
      },
      {
        "shortening": -0.002
      },
      {
        "motor": 0.7
      }
    ],
    "tip_force": [
      0.1,
      0.0,
      -0.2
    ],
    "tip_moment": [
      0.0,
      0.01,
      0.0
    ],
    "gravity": [
      0.0,
      0.0,
      -9.81
    ],
    "models": [
      "cosserat",
      "four-bar"
    ],
    "compliance": true,
    "target": [
      0.05,
      0.0,
      0.1
    ],
    "pull": {
      "arc_length": 0.1,
      "force": [
        0.0,
        0.2,
        0.0
      ]
    },
    "holes": [
      [
        1,
        2,
        3
      ],
      null
    ]
  },
  {
    "type": "survey",
    "id": 7,
    "commands": [
      {
        "tension": 1.5
      },
      {
        "shortening": -0.002
      },
      {
        "motor": 0.7
      }
    ],
    "tip_force": [
      0.1,
      0.0,
      -0.2
    ],
    "tip_moment": [
      0.0,
      0.01,
      0.0
    ],
    "gravity": [
      0.0,
      0.0,
      -9.81
    ],
    "models": [
      "cosserat",
      "four-bar"
    ],
    "compliance": true,
    "target": [
      0.05,
      0.0,
      0.1
    ],
    "pull": {
      "arc_length": 0.1,
      "force": [
        0.0,
        0.2,
        0.0
      ]
    },
    "holes": [
      [
        1,
        2,
        3
      ],
      null
    ]
  },
  {
    "type": "end_survey"
  },
  {
    "type": "play",
    "course": "motion",
    "request": {
      "id": 7,
      "commands": [
        {
          "tension": 1.5
        },
        {
          "shortening": -0.002
        },
        {
          "motor": 0.7
        }
      ],
      "tip_force": [
        0.1,
        0.0,
        -0.2
      ],
      "tip_moment": [
        0.0,
        0.01,
        0.0
      ],
      "gravity": [
        0.0,
        0.0,
        -9.81
      ],
      "models": [
        "cosserat",
        "four-bar"
      ],
      "compliance": true,
      "target": [
        0.05,
        0.0,
        0.1
      ],
      "pull": {
        "arc_length": 0.1,
        "force": [
          0.0,
          0.2,
          0.0
        ]
      },
      "holes": [
        [
          1,
          2,
          3
        ],
        null
      ]
    }
  },
  {
    "type": "end_play"
  },
  {
    "type": "design",
    "request": {
      "id": 7,
      "commands": [
        {
          "tension": 1.5
        },
        {
          "shortening": -0.002
        },
        {
          "motor": 0.7
        }
      ],
      "tip_force": [
        0.1,
        0.0,
        -0.2
      ],
      "tip_moment": [
        0.0,
        0.01,
        0.0
      ],
      "gravity": [
        0.0,
        0.0,
        -9.81
      ],
      "models": [
        "cosserat",
        "four-bar"
      ],
      "compliance": true,
      "target": [
        0.05,
        0.0,
        0.1
      ],
      "pull": {
        "arc_length": 0.1,
        "force": [
          0.0,
          0.2,
          0.0
        ]
      },
      "holes": [
        [
          1,
          2,
          3
        ],
        null
      ]
    },
    "cable": 0,
    "tension": true,
    "places": [
      [
        0.0,
        0.0,
        0.2
      ]
    ]
  },
  {
    "type": "end_design"
  }
];

export const toPage: ToPage[] = [
  {
    "type": "scene",
    "title": "Arm",
    "file": "arm.toml",
    "version": "0.0.0",
    "length": 0.2,
    "stations": [
      0.0,
      0.1,
      0.2
    ],
    "section": {
      "kind": "rectangle",
      "width": [
        0.01,
        0.01,
        0.01
      ],
      "height": [
        0.001,
        0.001,
        0.001
      ]
    },
    "disks": [
      {
        "station": 0,
        "radius": 0.01,
        "thickness": 0.001,
        "holes": [
          [
            0.008,
            0.0
          ]
        ],
        "hole_radius": 0.001
      }
    ],
    "cables": [
      {
        "name": "pull",
        "course": [
          [
            0.008,
            0.0
          ],
          [
            0.008,
            0.0
          ],
          [
            0.008,
            0.0
          ]
        ],
        "holes": [
          1
        ],
        "initial_length": 0.2
      }
    ],
    "motors": [
      {
        "name": "bend",
        "is_angular": true,
        "reach": [
          -3.0,
          3.0
        ],
        "pulls": [
          [
            0,
            0.01
          ]
        ],
        "limit": 0.2
      }
    ],
    "sliders": [
      {
        "motor": 0
      },
      {
        "cable": 0
      }
    ],
    "base": {
      "position": [
        0.0,
        0.0,
        0.1
      ],
      "orientation": [
        1.0,
        0.0,
        0.0,
        0.0
      ]
    },
    "models": [
      {
        "name": "cosserat",
        "hole_to_hole": false,
        "jointed": false,
        "refusal": null
      },
      {
        "name": "four-bar",
        "hole_to_hole": true,
        "jointed": false,
        "refusal": "why"
      }
    ],
    "initial": {
      "id": 7,
      "commands": [
        {
          "tension": 1.5
        },
        {
          "shortening": -0.002
        },
        {
          "motor": 0.7
        }
      ],
      "tip_force": [
        0.1,
        0.0,
        -0.2
      ],
      "tip_moment": [
        0.0,
        0.01,
        0.0
      ],
      "gravity": [
        0.0,
        0.0,
        -9.81
      ],
      "models": [
        "cosserat",
        "four-bar"
      ],
      "compliance": true,
      "target": [
        0.05,
        0.0,
        0.1
      ],
      "pull": {
        "arc_length": 0.1,
        "force": [
          0.0,
          0.2,
          0.0
        ]
      },
      "holes": [
        [
          1,
          2,
          3
        ],
        null
      ]
    },
    "ranges": {
      "tension": 10.0,
      "shortening": 0.02,
      "force": 1.0,
      "moment": 0.1,
      "gravity": 15.0
    },
    "loads_in_base": true,
    "tip_follower": false,
    "loads": [
      {
        "kind": "single",
        "arc_length": 0.1,
        "force": [
          0.1,
          0.0,
          0.0
        ],
        "moment": [
          0.0,
          0.0,
          0.01
        ],
        "follows": true
      },
      {
        "kind": "spread",
        "arc_lengths": [
          0.0,
          0.2
        ],
        "forces": [
          [
            0.0,
            1.0,
            0.0
          ],
          [
            0.0,
            1.0,
            0.0
          ]
        ],
        "moments": [
          [
            0.0,
            0.0,
            0.0
          ],
          [
            0.0,
            0.0,
            0.0
          ]
        ],
        "follows": false
      },
      {
        "kind": "mass",
        "arc_length": 0.2,
        "mass": 0.05
      }
    ],
    "other_loads": [
      "a load at a point"
    ],
    "courses": [
      {
        "course": "steps",
        "count": 4,
        "duration": null
      },
      {
        "course": "motion",
        "count": 101,
        "duration": 1.0
      }
    ],
    "measured": [
      [
        {
          "seen": {
            "kind": "position",
            "position": [
              0.0,
              0.0,
              0.2
            ]
          },
          "arc_length": 0.2,
          "offset": [
            0.0,
            0.005,
            0.0
          ]
        }
      ],
      [
        {
          "seen": {
            "kind": "line",
            "camera": 0,
            "origin": [
              0.0,
              -1.0,
              0.1
            ],
            "direction": [
              0.0,
              1.0,
              0.0
            ]
          },
          "arc_length": null,
          "offset": [
            0.0,
            0.0,
            0.0
          ]
        }
      ]
    ],
    "cameras": [
      {
        "name": "left",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "lens": {
          "kind": "pinhole",
          "focal": [
            800.0,
            810.0
          ],
          "centre": [
            320.0,
            240.0
          ]
        },
        "size": [
          640.0,
          480.0
        ],
        "columns": 2,
        "ideal": [
          [
            -0.5,
            -0.5
          ],
          null
        ]
      },
      {
        "name": "right",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "lens": {
          "kind": "orthographic",
          "scale": 2000.0,
          "centre": [
            320.0,
            240.0
          ]
        },
        "size": [
          640.0,
          480.0
        ],
        "columns": 1,
        "ideal": []
      }
    ],
    "obstacles": [
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "half_space"
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "sphere",
          "radius": 0.02
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "capsule",
          "radius": 0.02,
          "length": 0.1
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "box",
          "size": [
            0.1,
            0.2,
            0.3
          ]
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "cylinder",
          "radius": 0.02,
          "length": 0.1
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "pipe",
          "radius": 0.02,
          "middle": [
            [
              0.0,
              0.0,
              0.0
            ],
            [
              0.0,
              0.0,
              0.1
            ]
          ]
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "superellipsoid",
          "semi_axes": [
            0.1,
            0.2,
            0.3
          ],
          "exponents": [
            0.5,
            1.0
          ]
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "mesh",
          "vertices": [
            [
              0.0,
              0.0,
              0.0
            ],
            [
              0.1,
              0.0,
              0.0
            ],
            [
              0.0,
              0.1,
              0.0
            ]
          ],
          "triangles": [
            [
              0,
              1,
              2
            ]
          ]
        }
      }
    ],
    "warnings": [
      {
        "message": "what",
        "help": "do"
      }
    ]
  },
  {
    "type": "scene",
    "title": "Arm",
    "file": "arm.toml",
    "version": "0.0.0",
    "length": 0.2,
    "stations": [
      0.0,
      0.1,
      0.2
    ],
    "section": {
      "kind": "unknown"
    },
    "disks": [
      {
        "station": 0,
        "radius": 0.01,
        "thickness": 0.001,
        "holes": [
          [
            0.008,
            0.0
          ]
        ],
        "hole_radius": 0.001
      }
    ],
    "cables": [
      {
        "name": "pull",
        "course": [
          [
            0.008,
            0.0
          ],
          [
            0.008,
            0.0
          ],
          [
            0.008,
            0.0
          ]
        ],
        "holes": [
          1
        ],
        "initial_length": 0.2
      }
    ],
    "motors": [
      {
        "name": "bend",
        "is_angular": true,
        "reach": [
          -3.0,
          3.0
        ],
        "pulls": [
          [
            0,
            0.01
          ]
        ],
        "limit": 0.2
      }
    ],
    "sliders": [
      {
        "motor": 0
      },
      {
        "cable": 0
      }
    ],
    "base": {
      "position": [
        0.0,
        0.0,
        0.1
      ],
      "orientation": [
        1.0,
        0.0,
        0.0,
        0.0
      ]
    },
    "models": [
      {
        "name": "cosserat",
        "hole_to_hole": false,
        "jointed": false,
        "refusal": null
      },
      {
        "name": "four-bar",
        "hole_to_hole": true,
        "jointed": false,
        "refusal": "why"
      }
    ],
    "initial": {
      "id": 7,
      "commands": [
        {
          "tension": 1.5
        },
        {
          "shortening": -0.002
        },
        {
          "motor": 0.7
        }
      ],
      "tip_force": [
        0.1,
        0.0,
        -0.2
      ],
      "tip_moment": [
        0.0,
        0.01,
        0.0
      ],
      "gravity": [
        0.0,
        0.0,
        -9.81
      ],
      "models": [
        "cosserat",
        "four-bar"
      ],
      "compliance": true,
      "target": [
        0.05,
        0.0,
        0.1
      ],
      "pull": {
        "arc_length": 0.1,
        "force": [
          0.0,
          0.2,
          0.0
        ]
      },
      "holes": [
        [
          1,
          2,
          3
        ],
        null
      ]
    },
    "ranges": {
      "tension": 10.0,
      "shortening": 0.02,
      "force": 1.0,
      "moment": 0.1,
      "gravity": 15.0
    },
    "loads_in_base": true,
    "tip_follower": false,
    "loads": [
      {
        "kind": "single",
        "arc_length": 0.1,
        "force": [
          0.1,
          0.0,
          0.0
        ],
        "moment": [
          0.0,
          0.0,
          0.01
        ],
        "follows": true
      },
      {
        "kind": "spread",
        "arc_lengths": [
          0.0,
          0.2
        ],
        "forces": [
          [
            0.0,
            1.0,
            0.0
          ],
          [
            0.0,
            1.0,
            0.0
          ]
        ],
        "moments": [
          [
            0.0,
            0.0,
            0.0
          ],
          [
            0.0,
            0.0,
            0.0
          ]
        ],
        "follows": false
      },
      {
        "kind": "mass",
        "arc_length": 0.2,
        "mass": 0.05
      }
    ],
    "other_loads": [
      "a load at a point"
    ],
    "courses": [
      {
        "course": "steps",
        "count": 4,
        "duration": null
      },
      {
        "course": "motion",
        "count": 101,
        "duration": 1.0
      }
    ],
    "measured": [
      [
        {
          "seen": {
            "kind": "position",
            "position": [
              0.0,
              0.0,
              0.2
            ]
          },
          "arc_length": 0.2,
          "offset": [
            0.0,
            0.005,
            0.0
          ]
        }
      ],
      [
        {
          "seen": {
            "kind": "line",
            "camera": 0,
            "origin": [
              0.0,
              -1.0,
              0.1
            ],
            "direction": [
              0.0,
              1.0,
              0.0
            ]
          },
          "arc_length": null,
          "offset": [
            0.0,
            0.0,
            0.0
          ]
        }
      ]
    ],
    "cameras": [
      {
        "name": "left",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "lens": {
          "kind": "pinhole",
          "focal": [
            800.0,
            810.0
          ],
          "centre": [
            320.0,
            240.0
          ]
        },
        "size": [
          640.0,
          480.0
        ],
        "columns": 2,
        "ideal": [
          [
            -0.5,
            -0.5
          ],
          null
        ]
      },
      {
        "name": "right",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "lens": {
          "kind": "orthographic",
          "scale": 2000.0,
          "centre": [
            320.0,
            240.0
          ]
        },
        "size": [
          640.0,
          480.0
        ],
        "columns": 1,
        "ideal": []
      }
    ],
    "obstacles": [
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "half_space"
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "sphere",
          "radius": 0.02
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "capsule",
          "radius": 0.02,
          "length": 0.1
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "box",
          "size": [
            0.1,
            0.2,
            0.3
          ]
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "cylinder",
          "radius": 0.02,
          "length": 0.1
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "pipe",
          "radius": 0.02,
          "middle": [
            [
              0.0,
              0.0,
              0.0
            ],
            [
              0.0,
              0.0,
              0.1
            ]
          ]
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "superellipsoid",
          "semi_axes": [
            0.1,
            0.2,
            0.3
          ],
          "exponents": [
            0.5,
            1.0
          ]
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "mesh",
          "vertices": [
            [
              0.0,
              0.0,
              0.0
            ],
            [
              0.1,
              0.0,
              0.0
            ],
            [
              0.0,
              0.1,
              0.0
            ]
          ],
          "triangles": [
            [
              0,
              1,
              2
            ]
          ]
        }
      }
    ],
    "warnings": [
      {
        "message": "what",
        "help": "do"
      }
    ]
  },
  {
    "type": "scene",
    "title": "Arm",
    "file": "arm.toml",
    "version": "0.0.0",
    "length": 0.2,
    "stations": [
      0.0,
      0.1,
      0.2
    ],
    "section": {
      "kind": "round",
      "outer": [
        0.003,
        0.003,
        0.003
      ],
      "inner": [
        0.0,
        0.0,
        0.0
      ]
    },
    "disks": [
      {
        "station": 0,
        "radius": 0.01,
        "thickness": 0.001,
        "holes": [
          [
            0.008,
            0.0
          ]
        ],
        "hole_radius": 0.001
      }
    ],
    "cables": [
      {
        "name": "pull",
        "course": [
          [
            0.008,
            0.0
          ],
          [
            0.008,
            0.0
          ],
          [
            0.008,
            0.0
          ]
        ],
        "holes": [
          1
        ],
        "initial_length": 0.2
      }
    ],
    "motors": [
      {
        "name": "bend",
        "is_angular": true,
        "reach": [
          -3.0,
          3.0
        ],
        "pulls": [
          [
            0,
            0.01
          ]
        ],
        "limit": 0.2
      }
    ],
    "sliders": [
      {
        "motor": 0
      },
      {
        "cable": 0
      }
    ],
    "base": {
      "position": [
        0.0,
        0.0,
        0.1
      ],
      "orientation": [
        1.0,
        0.0,
        0.0,
        0.0
      ]
    },
    "models": [
      {
        "name": "cosserat",
        "hole_to_hole": false,
        "jointed": false,
        "refusal": null
      },
      {
        "name": "four-bar",
        "hole_to_hole": true,
        "jointed": false,
        "refusal": "why"
      }
    ],
    "initial": {
      "id": 7,
      "commands": [
        {
          "tension": 1.5
        },
        {
          "shortening": -0.002
        },
        {
          "motor": 0.7
        }
      ],
      "tip_force": [
        0.1,
        0.0,
        -0.2
      ],
      "tip_moment": [
        0.0,
        0.01,
        0.0
      ],
      "gravity": [
        0.0,
        0.0,
        -9.81
      ],
      "models": [
        "cosserat",
        "four-bar"
      ],
      "compliance": true,
      "target": [
        0.05,
        0.0,
        0.1
      ],
      "pull": {
        "arc_length": 0.1,
        "force": [
          0.0,
          0.2,
          0.0
        ]
      },
      "holes": [
        [
          1,
          2,
          3
        ],
        null
      ]
    },
    "ranges": {
      "tension": 10.0,
      "shortening": 0.02,
      "force": 1.0,
      "moment": 0.1,
      "gravity": 15.0
    },
    "loads_in_base": true,
    "tip_follower": false,
    "loads": [
      {
        "kind": "single",
        "arc_length": 0.1,
        "force": [
          0.1,
          0.0,
          0.0
        ],
        "moment": [
          0.0,
          0.0,
          0.01
        ],
        "follows": true
      },
      {
        "kind": "spread",
        "arc_lengths": [
          0.0,
          0.2
        ],
        "forces": [
          [
            0.0,
            1.0,
            0.0
          ],
          [
            0.0,
            1.0,
            0.0
          ]
        ],
        "moments": [
          [
            0.0,
            0.0,
            0.0
          ],
          [
            0.0,
            0.0,
            0.0
          ]
        ],
        "follows": false
      },
      {
        "kind": "mass",
        "arc_length": 0.2,
        "mass": 0.05
      }
    ],
    "other_loads": [
      "a load at a point"
    ],
    "courses": [
      {
        "course": "steps",
        "count": 4,
        "duration": null
      },
      {
        "course": "motion",
        "count": 101,
        "duration": 1.0
      }
    ],
    "measured": [
      [
        {
          "seen": {
            "kind": "position",
            "position": [
              0.0,
              0.0,
              0.2
            ]
          },
          "arc_length": 0.2,
          "offset": [
            0.0,
            0.005,
            0.0
          ]
        }
      ],
      [
        {
          "seen": {
            "kind": "line",
            "camera": 0,
            "origin": [
              0.0,
              -1.0,
              0.1
            ],
            "direction": [
              0.0,
              1.0,
              0.0
            ]
          },
          "arc_length": null,
          "offset": [
            0.0,
            0.0,
            0.0
          ]
        }
      ]
    ],
    "cameras": [
      {
        "name": "left",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "lens": {
          "kind": "pinhole",
          "focal": [
            800.0,
            810.0
          ],
          "centre": [
            320.0,
            240.0
          ]
        },
        "size": [
          640.0,
          480.0
        ],
        "columns": 2,
        "ideal": [
          [
            -0.5,
            -0.5
          ],
          null
        ]
      },
      {
        "name": "right",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "lens": {
          "kind": "orthographic",
          "scale": 2000.0,
          "centre": [
            320.0,
            240.0
          ]
        },
        "size": [
          640.0,
          480.0
        ],
        "columns": 1,
        "ideal": []
      }
    ],
    "obstacles": [
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "half_space"
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "sphere",
          "radius": 0.02
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "capsule",
          "radius": 0.02,
          "length": 0.1
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "box",
          "size": [
            0.1,
            0.2,
            0.3
          ]
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "cylinder",
          "radius": 0.02,
          "length": 0.1
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "pipe",
          "radius": 0.02,
          "middle": [
            [
              0.0,
              0.0,
              0.0
            ],
            [
              0.0,
              0.0,
              0.1
            ]
          ]
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "superellipsoid",
          "semi_axes": [
            0.1,
            0.2,
            0.3
          ],
          "exponents": [
            0.5,
            1.0
          ]
        }
      },
      {
        "name": "body",
        "pose": {
          "position": [
            0.0,
            0.0,
            0.1
          ],
          "orientation": [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        },
        "form": {
          "kind": "mesh",
          "vertices": [
            [
              0.0,
              0.0,
              0.0
            ],
            [
              0.1,
              0.0,
              0.0
            ],
            [
              0.0,
              0.1,
              0.0
            ]
          ],
          "triangles": [
            [
              0,
              1,
              2
            ]
          ]
        }
      }
    ],
    "warnings": [
      {
        "message": "what",
        "help": "do"
      }
    ]
  },
  {
    "type": "broken",
    "message": "why"
  },
  {
    "type": "frame",
    "id": 7,
    "time": 0.001,
    "answers": [
      {
        "status": "solved",
        "model": "cosserat",
        "positions": [
          [
            0.0,
            0.0,
            0.0
          ],
          [
            0.0,
            0.0,
            0.1
          ]
        ],
        "orientations": [
          [
            1.0,
            0.0,
            0.0,
            0.0
          ],
          [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        ],
        "strains": [
          [
            1.5,
            0.0,
            0.2,
            0.001,
            0.0,
            -0.001
          ]
        ],
        "moments": [
          [
            0.01,
            0.0,
            0.002
          ]
        ],
        "cables": [
          {
            "tension": 1.5,
            "length": 0.19,
            "initial_length": 0.2,
            "shortening": 0.001,
            "slack": false,
            "span_tensions": [
              1.5,
              1.4
            ]
          }
        ],
        "contacts": [
          {
            "obstacle": 0,
            "arc_length": 0.1,
            "point": [
              0.0,
              0.0,
              0.1
            ],
            "normal": [
              1.0,
              0.0,
              0.0
            ],
            "force": 0.3,
            "friction": [
              0.0,
              0.05,
              0.0
            ],
            "sticks": true
          }
        ],
        "grasps": [
          {
            "obstacle": 0,
            "contacts": 1,
            "sliding": 0,
            "normal_force": 0.3,
            "force": [
              -0.3,
              -0.05,
              0.0
            ],
            "moment": [
              0.0,
              0.0,
              0.001
            ],
            "slip_margin": 0.4
          }
        ],
        "objects": [
          {
            "obstacle": 0,
            "pose": {
              "position": [
                0.0,
                0.0,
                0.2
              ],
              "orientation": [
                1.0,
                0.0,
                0.0,
                0.0
              ]
            }
          }
        ],
        "residual": 1e-12,
        "iterations": 3,
        "stability": 0.9,
        "unstable": false,
        "solve_time": 0.00002,
        "driven_by": null,
        "compliance": {
          "status": "known",
          "values": [
            0.1,
            0.01,
            0.001
          ],
          "directions": [
            [
              1.0,
              0.0,
              0.0
            ],
            [
              0.0,
              1.0,
              0.0
            ],
            [
              0.0,
              0.0,
              1.0
            ]
          ]
        },
        "warnings": [
          {
            "message": "what",
            "help": "do"
          }
        ]
      },
      {
        "status": "solved",
        "model": "four-bar",
        "positions": [
          [
            0.0,
            0.0,
            0.0
          ],
          [
            0.0,
            0.0,
            0.1
          ]
        ],
        "orientations": [
          [
            1.0,
            0.0,
            0.0,
            0.0
          ],
          [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        ],
        "strains": [
          [
            1.5,
            0.0,
            0.2,
            0.001,
            0.0,
            -0.001
          ]
        ],
        "moments": null,
        "cables": [
          {
            "tension": null,
            "length": 0.19,
            "initial_length": 0.2,
            "shortening": 0.001,
            "slack": true,
            "span_tensions": []
          }
        ],
        "contacts": [],
        "grasps": [],
        "objects": [],
        "residual": 1e-12,
        "iterations": 3,
        "stability": null,
        "unstable": false,
        "solve_time": 0.00002,
        "driven_by": "cosserat",
        "compliance": {
          "status": "unknown",
          "message": "why"
        },
        "warnings": []
      },
      {
        "status": "failed",
        "model": "cosserat-disks",
        "message": "why"
      }
    ],
    "reach": {
      "status": "found",
      "reached": false,
      "commands": [
        {
          "tension": 1.5
        },
        {
          "shortening": -0.002
        },
        {
          "motor": 0.7
        }
      ],
      "distance": 0.002,
      "limits": [
        {
          "slider": 1,
          "words": "which"
        }
      ]
    },
    "cables": null
  },
  {
    "type": "frame",
    "id": 7,
    "time": 0.001,
    "answers": [
      {
        "status": "solved",
        "model": "cosserat",
        "positions": [
          [
            0.0,
            0.0,
            0.0
          ],
          [
            0.0,
            0.0,
            0.1
          ]
        ],
        "orientations": [
          [
            1.0,
            0.0,
            0.0,
            0.0
          ],
          [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        ],
        "strains": [
          [
            1.5,
            0.0,
            0.2,
            0.001,
            0.0,
            -0.001
          ]
        ],
        "moments": [
          [
            0.01,
            0.0,
            0.002
          ]
        ],
        "cables": [
          {
            "tension": 1.5,
            "length": 0.19,
            "initial_length": 0.2,
            "shortening": 0.001,
            "slack": false,
            "span_tensions": [
              1.5,
              1.4
            ]
          }
        ],
        "contacts": [
          {
            "obstacle": 0,
            "arc_length": 0.1,
            "point": [
              0.0,
              0.0,
              0.1
            ],
            "normal": [
              1.0,
              0.0,
              0.0
            ],
            "force": 0.3,
            "friction": [
              0.0,
              0.05,
              0.0
            ],
            "sticks": true
          }
        ],
        "grasps": [
          {
            "obstacle": 0,
            "contacts": 1,
            "sliding": 0,
            "normal_force": 0.3,
            "force": [
              -0.3,
              -0.05,
              0.0
            ],
            "moment": [
              0.0,
              0.0,
              0.001
            ],
            "slip_margin": 0.4
          }
        ],
        "objects": [
          {
            "obstacle": 0,
            "pose": {
              "position": [
                0.0,
                0.0,
                0.2
              ],
              "orientation": [
                1.0,
                0.0,
                0.0,
                0.0
              ]
            }
          }
        ],
        "residual": 1e-12,
        "iterations": 3,
        "stability": 0.9,
        "unstable": false,
        "solve_time": 0.00002,
        "driven_by": null,
        "compliance": {
          "status": "known",
          "values": [
            0.1,
            0.01,
            0.001
          ],
          "directions": [
            [
              1.0,
              0.0,
              0.0
            ],
            [
              0.0,
              1.0,
              0.0
            ],
            [
              0.0,
              0.0,
              1.0
            ]
          ]
        },
        "warnings": [
          {
            "message": "what",
            "help": "do"
          }
        ]
      },
      {
        "status": "solved",
        "model": "four-bar",
        "positions": [
          [
            0.0,
            0.0,
            0.0
          ],
          [
            0.0,
            0.0,
            0.1
          ]
        ],
        "orientations": [
          [
            1.0,
            0.0,
            0.0,
            0.0
          ],
          [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        ],
        "strains": [
          [
            1.5,
            0.0,
            0.2,
            0.001,
            0.0,
            -0.001
          ]
        ],
        "moments": null,
        "cables": [
          {
            "tension": null,
            "length": 0.19,
            "initial_length": 0.2,
            "shortening": 0.001,
            "slack": true,
            "span_tensions": []
          }
        ],
        "contacts": [],
        "grasps": [],
        "objects": [],
        "residual": 1e-12,
        "iterations": 3,
        "stability": null,
        "unstable": false,
        "solve_time": 0.00002,
        "driven_by": "cosserat",
        "compliance": {
          "status": "unknown",
          "message": "why"
        },
        "warnings": []
      },
      {
        "status": "failed",
        "model": "cosserat-disks",
        "message": "why"
      }
    ],
    "reach": {
      "status": "failed",
      "message": "why"
    },
    "cables": null
  },
  {
    "type": "cloud",
    "id": 8,
    "voxel": 0.01,
    "points": [
      [
        0.0,
        0.0,
        0.2
      ]
    ],
    "dexterity": [
      0.1
    ],
    "dimension": 3,
    "measure": 0.5,
    "complete": true
  },
  {
    "type": "track",
    "id": 9,
    "course": "motion",
    "from": 16,
    "moments": [
      {
        "time": 0.5,
        "answers": [
          {
            "status": "solved",
            "model": "cosserat",
            "positions": [
              [
                0.0,
                0.0,
                0.0
              ],
              [
                0.0,
                0.0,
                0.1
              ]
            ],
            "orientations": [
              [
                1.0,
                0.0,
                0.0,
                0.0
              ],
              [
                1.0,
                0.0,
                0.0,
                0.0
              ]
            ],
            "strains": [
              [
                1.5,
                0.0,
                0.2,
                0.001,
                0.0,
                -0.001
              ]
            ],
            "moments": [
              [
                0.01,
                0.0,
                0.002
              ]
            ],
            "cables": [
              {
                "tension": 1.5,
                "length": 0.19,
                "initial_length": 0.2,
                "shortening": 0.001,
                "slack": false,
                "span_tensions": [
                  1.5,
                  1.4
                ]
              }
            ],
            "contacts": [
              {
                "obstacle": 0,
                "arc_length": 0.1,
                "point": [
                  0.0,
                  0.0,
                  0.1
                ],
                "normal": [
                  1.0,
                  0.0,
                  0.0
                ],
                "force": 0.3,
                "friction": [
                  0.0,
                  0.05,
                  0.0
                ],
                "sticks": true
              }
            ],
            "grasps": [
              {
                "obstacle": 0,
                "contacts": 1,
                "sliding": 0,
                "normal_force": 0.3,
                "force": [
                  -0.3,
                  -0.05,
                  0.0
                ],
                "moment": [
                  0.0,
                  0.0,
                  0.001
                ],
                "slip_margin": 0.4
              }
            ],
            "objects": [
              {
                "obstacle": 0,
                "pose": {
                  "position": [
                    0.0,
                    0.0,
                    0.2
                  ],
                  "orientation": [
                    1.0,
                    0.0,
                    0.0,
                    0.0
                  ]
                }
              }
            ],
            "residual": 1e-12,
            "iterations": 3,
            "stability": 0.9,
            "unstable": false,
            "solve_time": 0.00002,
            "driven_by": null,
            "compliance": {
              "status": "known",
              "values": [
                0.1,
                0.01,
                0.001
              ],
              "directions": [
                [
                  1.0,
                  0.0,
                  0.0
                ],
                [
                  0.0,
                  1.0,
                  0.0
                ],
                [
                  0.0,
                  0.0,
                  1.0
                ]
              ]
            },
            "warnings": [
              {
                "message": "what",
                "help": "do"
              }
            ]
          },
          {
            "status": "solved",
            "model": "four-bar",
            "positions": [
              [
                0.0,
                0.0,
                0.0
              ],
              [
                0.0,
                0.0,
                0.1
              ]
            ],
            "orientations": [
              [
                1.0,
                0.0,
                0.0,
                0.0
              ],
              [
                1.0,
                0.0,
                0.0,
                0.0
              ]
            ],
            "strains": [
              [
                1.5,
                0.0,
                0.2,
                0.001,
                0.0,
                -0.001
              ]
            ],
            "moments": null,
            "cables": [
              {
                "tension": null,
                "length": 0.19,
                "initial_length": 0.2,
                "shortening": 0.001,
                "slack": true,
                "span_tensions": []
              }
            ],
            "contacts": [],
            "grasps": [],
            "objects": [],
            "residual": 1e-12,
            "iterations": 3,
            "stability": null,
            "unstable": false,
            "solve_time": 0.00002,
            "driven_by": "cosserat",
            "compliance": {
              "status": "unknown",
              "message": "why"
            },
            "warnings": []
          },
          {
            "status": "failed",
            "model": "cosserat-disks",
            "message": "why"
          }
        ],
        "acting": {
          "tip_force": [
            0.1,
            0.0,
            0.0
          ],
          "tip_moment": [
            0.0,
            0.0,
            0.0
          ],
          "tip_follower": false,
          "gravity": [
            0.0,
            0.0,
            -9.81
          ],
          "loads": [
            {
              "kind": "single",
              "arc_length": 0.1,
              "force": [
                0.1,
                0.0,
                0.0
              ],
              "moment": [
                0.0,
                0.0,
                0.01
              ],
              "follows": true
            },
            {
              "kind": "spread",
              "arc_lengths": [
                0.0,
                0.2
              ],
              "forces": [
                [
                  0.0,
                  1.0,
                  0.0
                ],
                [
                  0.0,
                  1.0,
                  0.0
                ]
              ],
              "moments": [
                [
                  0.0,
                  0.0,
                  0.0
                ],
                [
                  0.0,
                  0.0,
                  0.0
                ]
              ],
              "follows": false
            },
            {
              "kind": "mass",
              "arc_length": 0.2,
              "mass": 0.05
            }
          ]
        }
      }
    ],
    "complete": false,
    "message": null
  },
  {
    "type": "track",
    "id": 9,
    "course": "motion",
    "from": 16,
    "moments": [
      {
        "time": 0.5,
        "answers": [
          {
            "status": "solved",
            "model": "cosserat",
            "positions": [
              [
                0.0,
                0.0,
                0.0
              ],
              [
                0.0,
                0.0,
                0.1
              ]
            ],
            "orientations": [
              [
                1.0,
                0.0,
                0.0,
                0.0
              ],
              [
                1.0,
                0.0,
                0.0,
                0.0
              ]
            ],
            "strains": [
              [
                1.5,
                0.0,
                0.2,
                0.001,
                0.0,
                -0.001
              ]
            ],
            "moments": [
              [
                0.01,
                0.0,
                0.002
              ]
            ],
            "cables": [
              {
                "tension": 1.5,
                "length": 0.19,
                "initial_length": 0.2,
                "shortening": 0.001,
                "slack": false,
                "span_tensions": [
                  1.5,
                  1.4
                ]
              }
            ],
            "contacts": [
              {
                "obstacle": 0,
                "arc_length": 0.1,
                "point": [
                  0.0,
                  0.0,
                  0.1
                ],
                "normal": [
                  1.0,
                  0.0,
                  0.0
                ],
                "force": 0.3,
                "friction": [
                  0.0,
                  0.05,
                  0.0
                ],
                "sticks": true
              }
            ],
            "grasps": [
              {
                "obstacle": 0,
                "contacts": 1,
                "sliding": 0,
                "normal_force": 0.3,
                "force": [
                  -0.3,
                  -0.05,
                  0.0
                ],
                "moment": [
                  0.0,
                  0.0,
                  0.001
                ],
                "slip_margin": 0.4
              }
            ],
            "objects": [
              {
                "obstacle": 0,
                "pose": {
                  "position": [
                    0.0,
                    0.0,
                    0.2
                  ],
                  "orientation": [
                    1.0,
                    0.0,
                    0.0,
                    0.0
                  ]
                }
              }
            ],
            "residual": 1e-12,
            "iterations": 3,
            "stability": 0.9,
            "unstable": false,
            "solve_time": 0.00002,
            "driven_by": null,
            "compliance": {
              "status": "known",
              "values": [
                0.1,
                0.01,
                0.001
              ],
              "directions": [
                [
                  1.0,
                  0.0,
                  0.0
                ],
                [
                  0.0,
                  1.0,
                  0.0
                ],
                [
                  0.0,
                  0.0,
                  1.0
                ]
              ]
            },
            "warnings": [
              {
                "message": "what",
                "help": "do"
              }
            ]
          },
          {
            "status": "solved",
            "model": "four-bar",
            "positions": [
              [
                0.0,
                0.0,
                0.0
              ],
              [
                0.0,
                0.0,
                0.1
              ]
            ],
            "orientations": [
              [
                1.0,
                0.0,
                0.0,
                0.0
              ],
              [
                1.0,
                0.0,
                0.0,
                0.0
              ]
            ],
            "strains": [
              [
                1.5,
                0.0,
                0.2,
                0.001,
                0.0,
                -0.001
              ]
            ],
            "moments": null,
            "cables": [
              {
                "tension": null,
                "length": 0.19,
                "initial_length": 0.2,
                "shortening": 0.001,
                "slack": true,
                "span_tensions": []
              }
            ],
            "contacts": [],
            "grasps": [],
            "objects": [],
            "residual": 1e-12,
            "iterations": 3,
            "stability": null,
            "unstable": false,
            "solve_time": 0.00002,
            "driven_by": "cosserat",
            "compliance": {
              "status": "unknown",
              "message": "why"
            },
            "warnings": []
          },
          {
            "status": "failed",
            "model": "cosserat-disks",
            "message": "why"
          }
        ],
        "acting": {
          "tip_force": [
            0.1,
            0.0,
            0.0
          ],
          "tip_moment": [
            0.0,
            0.0,
            0.0
          ],
          "tip_follower": false,
          "gravity": [
            0.0,
            0.0,
            -9.81
          ],
          "loads": [
            {
              "kind": "single",
              "arc_length": 0.1,
              "force": [
                0.1,
                0.0,
                0.0
              ],
              "moment": [
                0.0,
                0.0,
                0.01
              ],
              "follows": true
            },
            {
              "kind": "spread",
              "arc_lengths": [
                0.0,
                0.2
              ],
              "forces": [
                [
                  0.0,
                  1.0,
                  0.0
                ],
                [
                  0.0,
                  1.0,
                  0.0
                ]
              ],
              "moments": [
                [
                  0.0,
                  0.0,
                  0.0
                ],
                [
                  0.0,
                  0.0,
                  0.0
                ]
              ],
              "follows": false
            },
            {
              "kind": "mass",
              "arc_length": 0.2,
              "mass": 0.05
            }
          ]
        }
      }
    ],
    "complete": true,
    "message": "why"
  },
  {
    "type": "beside",
    "number": 1,
    "scene": {
      "title": "Arm",
      "file": "arm.toml",
      "version": "0.0.0",
      "length": 0.2,
      "stations": [
        0.0,
        0.1,
        0.2
      ],
      "section": {
        "kind": "round",
        "outer": [
          0.003,
          0.003,
          0.003
        ],
        "inner": [
          0.0,
          0.0,
          0.0
        ]
      },
      "disks": [
        {
          "station": 0,
          "radius": 0.01,
          "thickness": 0.001,
          "holes": [
            [
              0.008,
              0.0
            ]
          ],
          "hole_radius": 0.001
        }
      ],
      "cables": [
        {
          "name": "pull",
          "course": [
            [
              0.008,
              0.0
            ],
            [
              0.008,
              0.0
            ],
            [
              0.008,
              0.0
            ]
          ],
          "holes": [
            1
          ],
          "initial_length": 0.2
        }
      ],
      "motors": [
        {
          "name": "bend",
          "is_angular": true,
          "reach": [
            -3.0,
            3.0
          ],
          "pulls": [
            [
              0,
              0.01
            ]
          ],
          "limit": 0.2
        }
      ],
      "sliders": [
        {
          "motor": 0
        },
        {
          "cable": 0
        }
      ],
      "base": {
        "position": [
          0.0,
          0.0,
          0.1
        ],
        "orientation": [
          1.0,
          0.0,
          0.0,
          0.0
        ]
      },
      "models": [
        {
          "name": "cosserat",
          "hole_to_hole": false,
          "jointed": false,
          "refusal": null
        },
        {
          "name": "four-bar",
          "hole_to_hole": true,
          "jointed": false,
          "refusal": "why"
        }
      ],
      "initial": {
        "id": 7,
        "commands": [
          {
            "tension": 1.5
          },
          {
            "shortening": -0.002
          },
          {
            "motor": 0.7
          }
        ],
        "tip_force": [
          0.1,
          0.0,
          -0.2
        ],
        "tip_moment": [
          0.0,
          0.01,
          0.0
        ],
        "gravity": [
          0.0,
          0.0,
          -9.81
        ],
        "models": [
          "cosserat",
          "four-bar"
        ],
        "compliance": true,
        "target": [
          0.05,
          0.0,
          0.1
        ],
        "pull": {
          "arc_length": 0.1,
          "force": [
            0.0,
            0.2,
            0.0
          ]
        },
        "holes": [
          [
            1,
            2,
            3
          ],
          null
        ]
      },
      "ranges": {
        "tension": 10.0,
        "shortening": 0.02,
        "force": 1.0,
        "moment": 0.1,
        "gravity": 15.0
      },
      "loads_in_base": true,
      "tip_follower": false,
      "loads": [
        {
          "kind": "single",
          "arc_length": 0.1,
          "force": [
            0.1,
            0.0,
            0.0
          ],
          "moment": [
            0.0,
            0.0,
            0.01
          ],
          "follows": true
        },
        {
          "kind": "spread",
          "arc_lengths": [
            0.0,
            0.2
          ],
          "forces": [
            [
              0.0,
              1.0,
              0.0
            ],
            [
              0.0,
              1.0,
              0.0
            ]
          ],
          "moments": [
            [
              0.0,
              0.0,
              0.0
            ],
            [
              0.0,
              0.0,
              0.0
            ]
          ],
          "follows": false
        },
        {
          "kind": "mass",
          "arc_length": 0.2,
          "mass": 0.05
        }
      ],
      "other_loads": [
        "a load at a point"
      ],
      "courses": [
        {
          "course": "steps",
          "count": 4,
          "duration": null
        },
        {
          "course": "motion",
          "count": 101,
          "duration": 1.0
        }
      ],
      "measured": [
        [
          {
            "seen": {
              "kind": "position",
              "position": [
                0.0,
                0.0,
                0.2
              ]
            },
            "arc_length": 0.2,
            "offset": [
              0.0,
              0.005,
              0.0
            ]
          }
        ],
        [
          {
            "seen": {
              "kind": "line",
              "camera": 0,
              "origin": [
                0.0,
                -1.0,
                0.1
              ],
              "direction": [
                0.0,
                1.0,
                0.0
              ]
            },
            "arc_length": null,
            "offset": [
              0.0,
              0.0,
              0.0
            ]
          }
        ]
      ],
      "cameras": [
        {
          "name": "left",
          "pose": {
            "position": [
              0.0,
              0.0,
              0.1
            ],
            "orientation": [
              1.0,
              0.0,
              0.0,
              0.0
            ]
          },
          "lens": {
            "kind": "pinhole",
            "focal": [
              800.0,
              810.0
            ],
            "centre": [
              320.0,
              240.0
            ]
          },
          "size": [
            640.0,
            480.0
          ],
          "columns": 2,
          "ideal": [
            [
              -0.5,
              -0.5
            ],
            null
          ]
        },
        {
          "name": "right",
          "pose": {
            "position": [
              0.0,
              0.0,
              0.1
            ],
            "orientation": [
              1.0,
              0.0,
              0.0,
              0.0
            ]
          },
          "lens": {
            "kind": "orthographic",
            "scale": 2000.0,
            "centre": [
              320.0,
              240.0
            ]
          },
          "size": [
            640.0,
            480.0
          ],
          "columns": 1,
          "ideal": []
        }
      ],
      "obstacles": [
        {
          "name": "body",
          "pose": {
            "position": [
              0.0,
              0.0,
              0.1
            ],
            "orientation": [
              1.0,
              0.0,
              0.0,
              0.0
            ]
          },
          "form": {
            "kind": "half_space"
          }
        },
        {
          "name": "body",
          "pose": {
            "position": [
              0.0,
              0.0,
              0.1
            ],
            "orientation": [
              1.0,
              0.0,
              0.0,
              0.0
            ]
          },
          "form": {
            "kind": "sphere",
            "radius": 0.02
          }
        },
        {
          "name": "body",
          "pose": {
            "position": [
              0.0,
              0.0,
              0.1
            ],
            "orientation": [
              1.0,
              0.0,
              0.0,
              0.0
            ]
          },
          "form": {
            "kind": "capsule",
            "radius": 0.02,
            "length": 0.1
          }
        },
        {
          "name": "body",
          "pose": {
            "position": [
              0.0,
              0.0,
              0.1
            ],
            "orientation": [
              1.0,
              0.0,
              0.0,
              0.0
            ]
          },
          "form": {
            "kind": "box",
            "size": [
              0.1,
              0.2,
              0.3
            ]
          }
        },
        {
          "name": "body",
          "pose": {
            "position": [
              0.0,
              0.0,
              0.1
            ],
            "orientation": [
              1.0,
              0.0,
              0.0,
              0.0
            ]
          },
          "form": {
            "kind": "cylinder",
            "radius": 0.02,
            "length": 0.1
          }
        },
        {
          "name": "body",
          "pose": {
            "position": [
              0.0,
              0.0,
              0.1
            ],
            "orientation": [
              1.0,
              0.0,
              0.0,
              0.0
            ]
          },
          "form": {
            "kind": "pipe",
            "radius": 0.02,
            "middle": [
              [
                0.0,
                0.0,
                0.0
              ],
              [
                0.0,
                0.0,
                0.1
              ]
            ]
          }
        },
        {
          "name": "body",
          "pose": {
            "position": [
              0.0,
              0.0,
              0.1
            ],
            "orientation": [
              1.0,
              0.0,
              0.0,
              0.0
            ]
          },
          "form": {
            "kind": "superellipsoid",
            "semi_axes": [
              0.1,
              0.2,
              0.3
            ],
            "exponents": [
              0.5,
              1.0
            ]
          }
        },
        {
          "name": "body",
          "pose": {
            "position": [
              0.0,
              0.0,
              0.1
            ],
            "orientation": [
              1.0,
              0.0,
              0.0,
              0.0
            ]
          },
          "form": {
            "kind": "mesh",
            "vertices": [
              [
                0.0,
                0.0,
                0.0
              ],
              [
                0.1,
                0.0,
                0.0
              ],
              [
                0.0,
                0.1,
                0.0
              ]
            ],
            "triangles": [
              [
                0,
                1,
                2
              ]
            ]
          }
        }
      ],
      "warnings": [
        {
          "message": "what",
          "help": "do"
        }
      ]
    },
    "answer": {
      "status": "solved",
      "model": "cosserat",
      "positions": [
        [
          0.0,
          0.0,
          0.0
        ],
        [
          0.0,
          0.0,
          0.1
        ]
      ],
      "orientations": [
        [
          1.0,
          0.0,
          0.0,
          0.0
        ],
        [
          1.0,
          0.0,
          0.0,
          0.0
        ]
      ],
      "strains": [
        [
          1.5,
          0.0,
          0.2,
          0.001,
          0.0,
          -0.001
        ]
      ],
      "moments": [
        [
          0.01,
          0.0,
          0.002
        ]
      ],
      "cables": [
        {
          "tension": 1.5,
          "length": 0.19,
          "initial_length": 0.2,
          "shortening": 0.001,
          "slack": false,
          "span_tensions": [
            1.5,
            1.4
          ]
        }
      ],
      "contacts": [
        {
          "obstacle": 0,
          "arc_length": 0.1,
          "point": [
            0.0,
            0.0,
            0.1
          ],
          "normal": [
            1.0,
            0.0,
            0.0
          ],
          "force": 0.3,
          "friction": [
            0.0,
            0.05,
            0.0
          ],
          "sticks": true
        }
      ],
      "grasps": [
        {
          "obstacle": 0,
          "contacts": 1,
          "sliding": 0,
          "normal_force": 0.3,
          "force": [
            -0.3,
            -0.05,
            0.0
          ],
          "moment": [
            0.0,
            0.0,
            0.001
          ],
          "slip_margin": 0.4
        }
      ],
      "objects": [
        {
          "obstacle": 0,
          "pose": {
            "position": [
              0.0,
              0.0,
              0.2
            ],
            "orientation": [
              1.0,
              0.0,
              0.0,
              0.0
            ]
          }
        }
      ],
      "residual": 1e-12,
      "iterations": 3,
      "stability": 0.9,
      "unstable": false,
      "solve_time": 0.00002,
      "driven_by": null,
      "compliance": {
        "status": "known",
        "values": [
          0.1,
          0.01,
          0.001
        ],
        "directions": [
          [
            1.0,
            0.0,
            0.0
          ],
          [
            0.0,
            1.0,
            0.0
          ],
          [
            0.0,
            0.0,
            1.0
          ]
        ]
      },
      "warnings": [
        {
          "message": "what",
          "help": "do"
        }
      ]
    }
  },
  {
    "type": "shown",
    "time": 0.5,
    "shapes": [
      {
        "status": "solved",
        "model": "cosserat",
        "positions": [
          [
            0.0,
            0.0,
            0.0
          ],
          [
            0.0,
            0.0,
            0.1
          ]
        ],
        "orientations": [
          [
            1.0,
            0.0,
            0.0,
            0.0
          ],
          [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        ],
        "strains": [
          [
            1.5,
            0.0,
            0.2,
            0.001,
            0.0,
            -0.001
          ]
        ],
        "moments": [
          [
            0.01,
            0.0,
            0.002
          ]
        ],
        "cables": [
          {
            "tension": 1.5,
            "length": 0.19,
            "initial_length": 0.2,
            "shortening": 0.001,
            "slack": false,
            "span_tensions": [
              1.5,
              1.4
            ]
          }
        ],
        "contacts": [
          {
            "obstacle": 0,
            "arc_length": 0.1,
            "point": [
              0.0,
              0.0,
              0.1
            ],
            "normal": [
              1.0,
              0.0,
              0.0
            ],
            "force": 0.3,
            "friction": [
              0.0,
              0.05,
              0.0
            ],
            "sticks": true
          }
        ],
        "grasps": [
          {
            "obstacle": 0,
            "contacts": 1,
            "sliding": 0,
            "normal_force": 0.3,
            "force": [
              -0.3,
              -0.05,
              0.0
            ],
            "moment": [
              0.0,
              0.0,
              0.001
            ],
            "slip_margin": 0.4
          }
        ],
        "objects": [
          {
            "obstacle": 0,
            "pose": {
              "position": [
                0.0,
                0.0,
                0.2
              ],
              "orientation": [
                1.0,
                0.0,
                0.0,
                0.0
              ]
            }
          }
        ],
        "residual": 1e-12,
        "iterations": 3,
        "stability": 0.9,
        "unstable": false,
        "solve_time": 0.00002,
        "driven_by": null,
        "compliance": {
          "status": "known",
          "values": [
            0.1,
            0.01,
            0.001
          ],
          "directions": [
            [
              1.0,
              0.0,
              0.0
            ],
            [
              0.0,
              1.0,
              0.0
            ],
            [
              0.0,
              0.0,
              1.0
            ]
          ]
        },
        "warnings": [
          {
            "message": "what",
            "help": "do"
          }
        ]
      },
      null
    ],
    "measured": [
      [
        0.0,
        0.0,
        0.1
      ]
    ]
  },
  {
    "type": "no_cloud",
    "id": 8,
    "message": "why"
  },
  {
    "type": "designed",
    "id": 10,
    "holes": [
      1,
      2
    ],
    "commands": [
      {
        "tension": 1.5
      },
      {
        "shortening": -0.002
      },
      {
        "motor": 0.7
      }
    ],
    "error": 0.001,
    "largest": 0.002,
    "proven": true
  },
  {
    "type": "no_design",
    "id": 10,
    "message": "why"
  },
  {
    "type": "frame",
    "id": 7,
    "time": 0.001,
    "answers": [
      {
        "status": "solved",
        "model": "cosserat",
        "positions": [
          [
            0.0,
            0.0,
            0.0
          ],
          [
            0.0,
            0.0,
            0.1
          ]
        ],
        "orientations": [
          [
            1.0,
            0.0,
            0.0,
            0.0
          ],
          [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        ],
        "strains": [
          [
            1.5,
            0.0,
            0.2,
            0.001,
            0.0,
            -0.001
          ]
        ],
        "moments": [
          [
            0.01,
            0.0,
            0.002
          ]
        ],
        "cables": [
          {
            "tension": 1.5,
            "length": 0.19,
            "initial_length": 0.2,
            "shortening": 0.001,
            "slack": false,
            "span_tensions": [
              1.5,
              1.4
            ]
          }
        ],
        "contacts": [
          {
            "obstacle": 0,
            "arc_length": 0.1,
            "point": [
              0.0,
              0.0,
              0.1
            ],
            "normal": [
              1.0,
              0.0,
              0.0
            ],
            "force": 0.3,
            "friction": [
              0.0,
              0.05,
              0.0
            ],
            "sticks": true
          }
        ],
        "grasps": [
          {
            "obstacle": 0,
            "contacts": 1,
            "sliding": 0,
            "normal_force": 0.3,
            "force": [
              -0.3,
              -0.05,
              0.0
            ],
            "moment": [
              0.0,
              0.0,
              0.001
            ],
            "slip_margin": 0.4
          }
        ],
        "objects": [
          {
            "obstacle": 0,
            "pose": {
              "position": [
                0.0,
                0.0,
                0.2
              ],
              "orientation": [
                1.0,
                0.0,
                0.0,
                0.0
              ]
            }
          }
        ],
        "residual": 1e-12,
        "iterations": 3,
        "stability": 0.9,
        "unstable": false,
        "solve_time": 0.00002,
        "driven_by": null,
        "compliance": {
          "status": "known",
          "values": [
            0.1,
            0.01,
            0.001
          ],
          "directions": [
            [
              1.0,
              0.0,
              0.0
            ],
            [
              0.0,
              1.0,
              0.0
            ],
            [
              0.0,
              0.0,
              1.0
            ]
          ]
        },
        "warnings": [
          {
            "message": "what",
            "help": "do"
          }
        ]
      },
      {
        "status": "solved",
        "model": "four-bar",
        "positions": [
          [
            0.0,
            0.0,
            0.0
          ],
          [
            0.0,
            0.0,
            0.1
          ]
        ],
        "orientations": [
          [
            1.0,
            0.0,
            0.0,
            0.0
          ],
          [
            1.0,
            0.0,
            0.0,
            0.0
          ]
        ],
        "strains": [
          [
            1.5,
            0.0,
            0.2,
            0.001,
            0.0,
            -0.001
          ]
        ],
        "moments": null,
        "cables": [
          {
            "tension": null,
            "length": 0.19,
            "initial_length": 0.2,
            "shortening": 0.001,
            "slack": true,
            "span_tensions": []
          }
        ],
        "contacts": [],
        "grasps": [],
        "objects": [],
        "residual": 1e-12,
        "iterations": 3,
        "stability": null,
        "unstable": false,
        "solve_time": 0.00002,
        "driven_by": "cosserat",
        "compliance": {
          "status": "unknown",
          "message": "why"
        },
        "warnings": []
      },
      {
        "status": "failed",
        "model": "cosserat-disks",
        "message": "why"
      }
    ],
    "reach": {
      "status": "found",
      "reached": false,
      "commands": [
        {
          "tension": 1.5
        },
        {
          "shortening": -0.002
        },
        {
          "motor": 0.7
        }
      ],
      "distance": 0.002,
      "limits": [
        {
          "slider": 1,
          "words": "which"
        }
      ]
    },
    "cables": [
      {
        "name": "pull",
        "course": [
          [
            0.008,
            0.0
          ],
          [
            0.008,
            0.0
          ],
          [
            0.008,
            0.0
          ]
        ],
        "holes": [
          1
        ],
        "initial_length": 0.2
      }
    ]
  },
  {
    "type": "error",
    "message": "why"
  }
];
