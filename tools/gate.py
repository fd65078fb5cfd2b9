#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files are read through io/plain_file.c and made through io/replace.c, by no other unit of src/. Looks for the
functions that open, list or remove files among the undefined symbols of each object file.

    tools/gate.py BUILD          from the project's root

Prints each unit that goes around the gate and exits 1; prints nothing and exits 0 if there is none."""
import sys

import circles

# Functions by what they do. __NAME_2 and the like are those of the fortified C library, NAME64 of large files.
GROUPS = {
    "open": "open openat fopen freopen creat open_by_handle_at openat2 syscall popen tmpfile mkstemp mkostemp "
            "posix_spawn_file_actions_addopen mmap shm_open sendfile copy_file_range",
    "list": "opendir fdopendir scandir ftw nftw glob",
    "library": "H5Fopen H5Fcreate H5Fis_hdf5 H5Fis_accessible H5Fmount H5FDopen config_read_file config_read "
               "config_write_file config_set_include_dir gmshOpen gmshMerge gmshWrite ut_read_xml "
               "cholmod_read_sparse cholmod_read_matrix gsl_matrix_fread XML_Parse",
    "remove": "unlink unlinkat remove rmdir rename renameat renameat2 truncate ftruncate link linkat symlink "
              "mknod mkfifo mkdtemp mkdir mkdirat",
    "stream": "stdin",
}

# The units that may, with the reason.
ALLOWED = {
    "io/plain_file": {"open": "the gate"},
    "io/replace": {"open": "makes new files, and reopens its own for fsync",
                   "list": "looks for what killed processes left", "remove": "renames, and removes its own files"},
    "io/folder": {"open": "softfall's own folders and their marks", "list": "of these folders",
                  "remove": "makes and removes them"},
    "io/staging": {"open": "its own folders", "list": "of these, of the folders of killed processes, of the folder to fill",
                   "remove": "of files that --force replaces, and of its own"},
    "io/h5": {"library": "creates new files only"},
    "io/h5_file": {"library": "opens what has passed the gate (/proc/self/fd)"},
    "io/process": {"open": "/dev/null and the log of another program"},
    "pre/mesher/confine": {"open": "numbers of its own process in /proc, before it is confined"},
    "pre/mesher/serve": {"open": "the number of its threads in /proc, and clone with CLONE_PARENT, which fork() cannot do"},
    "pre/mesher/work": {"library": "the process of gmsh, which cannot open files: the gate of softfall-pre does it"},
    "pre/mesh/broker": {"open": "its own sealed copies in memory, anew for each reader"},
    "pre/mesh/mesher": {"open": "/proc/meminfo, and /dev/null for the process of gmsh"},
    "base/units": {"library": "the unit system of UDUNITS"},
    "post/view/xdmf": {"list": "for the data of earlier runs of softfall-post",
                  "remove": "these data, and moves new ones within its own folder"},
    "solver/run/output": {"remove": "its own partial files"},
    "programs/softfall-solve": {"remove": "results and checkpoint of an earlier run, with --force"},
    "programs/softfall-new": {"list": "the folder of the examples"},
    "study/material_file": {"remove": "a material that it has just written and that is refused"},
}


# The only units that may call gmsh: those of the process that is confined.
GMSH = ("pre/mesher/",)


def plain(symbol):
    """open for open64, __open_2, __open64_2, open@GLIBC_2.2.5."""
    name = symbol.split("@")[0]
    for ending in ("_2", "64"):
        name = name.removesuffix(ending)
    return name.lstrip("_") if name.startswith("__") else name


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    group_of = {name: group for group, names in GROUPS.items() for name in names.split()}
    used = {}
    wrong = 0
    for unit, symbols in circles.symbols(sys.argv[1])[1].items():
        if not unit.startswith(GMSH) and any(symbol.startswith("gmsh") for symbol in symbols):
            wrong += 1
            print(f"src/{unit}.c calls gmsh, which only the units of {' and '.join(GMSH)} may")
        for symbol in symbols:
            group = group_of.get(plain(symbol))
            if group:
                used.setdefault(unit, {}).setdefault(group, set()).add(plain(symbol))
    for unit, groups in sorted(used.items()):
        for group, names in sorted(groups.items()):
            if group not in ALLOWED.get(unit, {}):
                wrong += 1
                print(f"src/{unit}.c goes around the gate: {', '.join(sorted(names))} (files are read through "
                      "io/plain_file.h, and made and removed through io/replace.h, io/folder.h and io/staging.h)")
    for unit, groups in sorted(ALLOWED.items()):
        for group in groups:
            if group not in used.get(unit, {}):
                wrong += 1
                print(f"tools/gate.py allows src/{unit}.c to {group}, which it does not do: take it out")
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
