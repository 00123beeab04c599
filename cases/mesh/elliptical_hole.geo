// A quarter of a plate with an elliptical hole in its middle, of quadrilaterals; in metres:
//   gmsh -2 -format msh41 elliptical_hole.geo -o elliptical_hole.msh
//   gmsh -2 -format msh41 -setnumber h 0.3125e-3 elliptical_hole.geo -o fine.msh
// With -setnumber half 1 the half at x > 0, below and above the hole's axis.
If (!Exists(h))
  h = 1.25e-3;    // size of the elements
EndIf
If (!Exists(half))
  half = 0;
EndIf
If (!Exists(height))
  height = 75e-3;
EndIf
width = 50e-3;
a = 10e-3;        // semi-axis across the load, along x
b = 5e-3;         // semi-axis along the load

Point(1) = {0, 0, 0, h};
Point(2) = {a, 0, 0, h};
Point(4) = {width, height, 0, h};
Point(5) = {0, height, 0, h};
Point(6) = {0, b, 0, h};
Ellipse(5) = {6, 1, 2, 2};
Line(3) = {4, 5};
Line(4) = {5, 6};
If (half)
  Point(7) = {0, -b, 0, h};
  Point(8) = {0, -height, 0, h};
  Point(9) = {width, -height, 0, h};
  Ellipse(6) = {2, 1, 2, 7};
  Line(7) = {7, 8};
  Line(8) = {8, 9};
  Line(2) = {9, 4};
  Curve Loop(1) = {5, 6, 7, 8, 2, 3, 4};
  Physical Curve("bottom", 11) = {8};
  Physical Curve("middle", 14) = {4, 7};
  Physical Curve("hole", 15) = {5, 6};
Else
  Point(3) = {width, 0, 0, h};
  Line(1) = {2, 3};
  Line(2) = {3, 4};
  Curve Loop(1) = {1, 2, 3, 4, 5};
  Physical Curve("ligament", 11) = {1};
  Physical Curve("middle", 14) = {4};
  Physical Curve("hole", 15) = {5};
EndIf
Physical Curve("right", 12) = {2};
Physical Curve("top", 13) = {3};
Plane Surface(1) = {1};
Physical Surface("plate", 16) = {1};
Mesh.Algorithm = 6;  // frontal Delaunay
Mesh.RecombineAll = 1;
Mesh.RecombinationAlgorithm = 1;  // by blossoms
