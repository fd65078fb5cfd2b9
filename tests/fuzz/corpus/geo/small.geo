DefineConstant[ side = {1, Name "a"}, b = 2 ]; /* c */ // d
Printf("x %g", side);
Physical Volume("pad") = {1};
