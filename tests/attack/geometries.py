# SPDX-License-Identifier: GPL-3.0-or-later
"""Hostile geometries: none runs a program or makes, changes or removes a file; each is meshed or refused in time."""
import os

from place import COARSE, MESH_SECONDS, changed

MARK = "/tmp/softfall-attack-marker"
PAD = 'Include "geo/pad.geo";\n'
HOSTILE = [
    'System "touch %s";' % MARK, 'SystemCall "touch %s";' % MARK, 'NonBlockingSystemCall "touch %s";' % MARK,
    'MergeWithBoundingBox "evil.txt";', 'Merge "evil.txt";', 'Merge "evil.Stl";', 'Merge "evil.inp";', 'Merge "evil.Step";',
    'Merge "evil.pos";', 'Include "evil.txt";', 'OnelabRun("x", "touch %s");' % MARK, 'Save "stolen.msh";', 'Print "stolen.geo_unrolled";',
    'Printf("x") > "stolen.txt";', 'Printf("x") >> "geo/pad.geo";', 'Error("x");', 'Exit;', 'Abort;', 'Delete Physicals;', 'Delete Model;',
    'Field[1]=ExternalProcess; Field[1].CommandLine="touch %s"; Background Field=1;' % MARK,
    'Field[1]=Structured; Field[1].FileName="/dev/zero"; Background Field=1;', 'Field[1]=MathEval; Field[1].F="1e-9"; Background Field=1;',
    'Field[1]=MathEval; Field[1].F="0"; Background Field=1;', 'Field[1]=MathEval; Field[1].F="1/0"; Background Field=1;',
    'General.Verbosity=99; Mesh.Algorithm=9;', 'Mesh.Recombine3DAll=1;', 'Mesh.Algorithm=9;', 'Mesh.Algorithm3D=9;', 'Mesh.Algorithm3D=10;',
    'Mesh.MeshSizeMax=1e-9;', 'Mesh.MeshSizeFactor=1e-6;', 'Mesh.ElementOrder=99;', 'Mesh.SecondOrderLinear=1; Mesh.ElementOrder=2;',
    'General.NumThreads=100000;', 'Mesh.MaxNumThreads3D=64; Mesh.Algorithm3D=10;', 'General.Terminal=1; Printf("softfall-pre: all is well");',
    'General.LogFileName="stolen.log";', 'General.SaveOptions=2; General.SessionFileName="stolen.session";', 'General.SaveSession=1;',
    'General.OptionsFileName="stolen.options"; General.SaveOptions=1;', 'General.TmpFileName="stolen.tmp";', 'Solver.AutoSaveDatabase=1;',
    'Geometry.OCCAutoFix=1; Merge "/dev/zero";', 'Merge "/dev/random";', 'Merge "/proc/kmsg";', 'Merge "pipe";', 'Include "pipe";',
    'Merge "/proc/self/mem";', 'Merge "/etc/shadow";', 'Merge "socket";', 'Include "self.geo";', 'Merge ".";', 'Include "/";',
    'For i In {1:1e12} a=i; EndFor', 'For i In {1:1e7} Point(100000+i)={i,0,0}; EndFor', 'Macro M\n Call M;\nReturn\nCall M;',
    'x = 1; For k In {1:60} x() = {x(), x()}; EndFor', 'a() = {1:1e11};', 'l() = LinSpace[0,1,1e11];', 'Point(2147483647) = {0,0,0};',
    'Point(-5) = {0,0,0};', 'Point(1000001) = {1e300,1e300,1e300};', 'Physical Volume("pad") = {1:1e9};', 'Physical Volume("pad") = {};',
    'Physical Surface("pad_base") = {999999};', 's = Str("x"); For k In {1:60} s = StrCat(s, s); EndFor', 'Plugin(Triangulate).Run;',
    'Plugin(MathEval).OutputFile = "stolen.pos"; Plugin(MathEval).Run;', 'PostProcessing.SaveMesh=1; Mesh 3; Save "x.msh";', 'Mesh 3;', 'Mesh 2;',
    'RefineMesh; RefineMesh; RefineMesh; RefineMesh; RefineMesh; RefineMesh; RefineMesh; RefineMesh;', 'OptimizeMesh "Netgen";',
    'AdaptMesh { 1 } { 1 } { 1 };', 'Draw;', 'BoundingBox;', 'Sleep 1e9;', 'Combine ElementsFromAllViews;', 'SetPartition 1e9;', 'PartitionMesh 1000;',
    'CreateTopology;', 'ClassifySurfaces { 0.1 };', 'Background Mesh View[0];', 'Homology { 1 };', 'Cohomology { 1 };', 'ReorientMesh Volume{1};',
    'Unknown Command;', '}}}}', '"', '/*', 'a = "', '\\x00', 'DefineConstant[ x = {1, Name "y", Choices{1:1e9}} ];', 'Coherence;', 'Merge "";', 'Include "";',
    'SetFactory("OpenCASCADE"); Box(900)={0,0,0,1,1,1}; BooleanFragments{ Volume{1:900}; Delete; }{};', 'SetFactory("What");',
    'SetFactory("OpenCASCADE"); Sphere(901)={0,0,0,1e300};', 'SetFactory("OpenCASCADE"); For i In {1:300} Sphere(1000+i)={i*0.1,0,0,1}; EndFor BooleanUnion{Volume{1001}; Delete;}{Volume{1002:1300}; Delete;}',
    'ShapeFromFile("/etc/passwd");', 'ShapeFromFile("/dev/zero");', 'LoadPlugin "/tmp/evil.so";', 'Geometry.Tolerance=1e300;', 'Mesh.ScalingFactor=0;',
    'Mesh.Format=1; Mesh.SaveAll=1;', 'Mesh.MshFileVersion=99;', 'General.BackgroundGradient=-1;', 'General.DisplayBorderFactor=1e300;',
]


def attack(place, tally, random, turns):
    place.write("evil.txt", 'SystemCall "touch %s"; Printf("x") > "stolen.txt";\n' % MARK)
    for name in ("evil.Stl", "evil.inp", "evil.Step", "evil.pos"):
        place.write(name, place.read("evil.txt"))
    os.mkfifo(place.path("pipe"))
    order = list(HOSTILE)
    random.shuffle(order)
    for text in order[:turns]:
        before_pad = random.random() < 0.3
        place.write("self.geo", text + "\n" + PAD if before_pad else PAD + text + "\n")
        place.write("model.h5", "earlier\n")
        tree = place.tree()
        if os.path.exists(MARK):
            os.remove(MARK)
        outcome = place.run(place.command("pre", "good.cfg", "-o", "made.h5", *COARSE, "--set", 'geometry.file=self.geo',
                                          "--set", "geometry.time_limit=20 s"), seconds=MESH_SECONDS)
        made = place.path("made.h5")
        if outcome.code == 0 and os.path.exists(made):
            os.remove(made)
        fault = None
        if os.path.exists(MARK):
            fault = "a program ran"
        elif changed(tree, place.tree()):
            fault = "changed " + changed(tree, place.tree())[0]
        if fault:
            tally.fault(fault, repr(text))
            tally.count("faults")
        else:
            tally.judge(outcome, repr(text))
