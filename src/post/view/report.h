/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "post/figures/compare.h"

/* Curves as CSV: a heading whose names carry the units, then one row per point. */

/* history.csv: every row of the history; the filtered acceleration is interpolated to its instants. */
sf_status sf_csv_write_history(const sf_staging *output, const sf_results *results, const sf_figures *figures,
                               sf_error *err);

/* acceleration.csv: the filtered curve of which a_max and HIC are, uniform samples from free flight on. */
sf_status sf_csv_write_acceleration(const sf_staging *output, const sf_figures *figures, sf_error *err);

/* compression.csv: engineering strain (indentation / thickness) and nominal stress (contact force / mean
 * cross-section at rest) of every row; of a run with a prescribed motion. */
sf_status sf_csv_write_compression(const sf_staging *output, const sf_results *results,
                                   const sf_figures *figures, sf_error *err);

/* reference.csv: the measured curve on the clock of the model, and the model at the same instants (empty
 * outside). */
sf_status sf_csv_write_reference(const sf_staging *output, const sf_comparison *comparison,
                                 const sf_figures *figures, sf_error *err);

/* section.csv: the pad's mid-section at the instant of the largest acceleration. Rows of the set `section`
 * are the nodes of the vertical plane y = constant through the missile's axis (nodes within half their own
 * spacing of it); rows of the set `axis` are points under the axis, evenly spaced through the thickness,
 * interpolated linearly in the cells. */

enum { SF_SECTION_STATIONS = 41 }; /* points under the axis */

/* A point of the section: the mean of up to 4 nodes with barycentric weights. */
typedef struct sf_section_point {
    int32_t node[4];
    double weight[4];
    double fit; /* smallest weight: 0 or more inside the tetrahedron, the best so far while searching */
} sf_section_point;

/* The points under the axis, top to bottom, evenly spaced; returns the height of the top (m). */
double sf_section_stations(const sf_results *results, sf_section_point station[SF_SECTION_STATIONS]);
/* True if the point lies in a cell; otherwise its mean has no meaning. */
bool sf_section_inside(const sf_section_point *point);
/* A component of a field ([node_count][components]) there. */
double sf_section_mean(const double *field, int components, int component, const sf_section_point *point);

/* Writes the section of /peak, or without it of the frame of the largest acceleration. `*written` is false
 * if that holds no von Mises stress: then there is no file. */
sf_status sf_section_write(const sf_staging *output, const sf_results *results, bool *written, sf_error *err);

/* The contents of pad.xdmf: the frames that are shown, and their data as an HDF5 file. */

typedef struct sf_xdmf_options {
    const char *command_line;
    bool full; /* doubles as they are in results.h5; else floats, see SF_XDMF_BITS */
} sf_xdmf_options;

/* The largest magnitude of an array in a frame has so many bits as a float, and all its values are whole
 * multiples of the last one, so that compression has something to take: the error is at most a millionth of
 * that magnitude. */
enum { SF_XDMF_BITS = 20 };

/* The frames of results.h5 and, in its place among them by time, /peak. */
typedef struct sf_shown {
    int64_t count;                   /* of those that could be read, once the data are written */
    int64_t peak;                    /* which is /peak, -1: none */
    const sf_frame_head **head;      /* [count] of the results; owned */
    double largest[SF_FRAME_FIELDS]; /* magnitude in the data */
    int *fields;                     /* [count] SF_FIELD_* bits; known once the data are written; owned */
} sf_shown;

/* Release with sf_shown_free. */
sf_status sf_shown_find(const sf_results *results, sf_shown *shown, sf_error *err);
void sf_shown_free(sf_shown *shown);

/* pad.xdmf and its data, pad-HASH.h5: the deformed pad with its cells, materials and fields, and the
 * missile's surface with its speed, deceleration and contact force, at every frame and at the peak, for
 * ParaView. Written so that all three XDMF readers of ParaView 5.11 take it: the topology is repeated in
 * every step (no Reference), connectivities are int32, number types and precisions are explicit, tensors have
 * nine components. The data bear the hash of their content in their name: a pad.xdmf never speaks of those of
 * another run, whenever softfall-post is killed. Array names carry their units, e.g. von_mises_Pa. */

enum { SF_XDMF_NAME_SIZE = 32 };

typedef struct sf_xdmf {
    int64_t frames;                  /* written; 0: there are no files */
    int fields;                      /* SF_FIELD_* bits that all of them have */
    double largest[SF_FRAME_FIELDS]; /* magnitude of each in all frames, SI */
    double peak_time;                /* s, of the frame that is /peak of results.h5; NaN: there is none */
} sf_xdmf;

/* `data` is the name of the file of the data; without frames it stays as it is. A frame that cannot be read
 * ends the export with a note if the run did not end well, and is an error otherwise. */
sf_status sf_xdmf_write(const sf_staging *output, sf_results *results, const sf_xdmf_options *options,
                        char data[SF_XDMF_NAME_SIZE], sf_xdmf *made, sf_error *err);

/* Removes data of earlier runs from the directory, after pad.xdmf is in its place: files pad-HASH.h5 with
 * that hash that no .xdmf file there names, but not `data`. */
void sf_xdmf_remove_old(const char *directory, const char *data);

/* A drop and the figures that softfall-post has computed of it, for its files. */
typedef struct sf_summary {
    const char *results_path;
    const char *reference_path; /* NULL without comparison */
    const char *command_line;   /* of softfall-post */
    const sf_results *results;
    const sf_figures *figures;
    const sf_comparison *comparison; /* NULL: nothing was measured */
    const sf_verdict *verdict;
} sf_summary;

/* acceleration.png: the curves, the HIC window and the limit; acceleration.gp, which draws the picture again,
 * or differently, stays beside it. Of a run with a prescribed motion compression.png: stress over strain. */

/* Columns of the key: three entries such as "HIC 595.2: 6.54 to 15.33 ms" do not fit beside each other. */
enum { SF_PLOT_KEY_COLUMNS = 2 };

/* The name of the script without its ending. */
const char *sf_plot_name(const sf_figures *figures);

/* Writes the script and the picture, which names the verdict and shows its limits. If gnuplot is absent or
 * fails, `warning` (size bytes) says so in a sentence, and that is no error; otherwise it is "". */
sf_status sf_plot_write(const sf_staging *output, const sf_summary *summary, char *warning, size_t size,
                        sf_error *err);

/* Instants (s) between which the axis of the pulse runs: where the model's curve is above 2 % of its largest
 * value, or the measured one above 5 %, and a margin; all of a run without a pulse. */
void sf_plot_time_range(const sf_figures *figures, const sf_comparison *comparison, double range[2]);

/* Returns the largest difference of two curves over the range, over the largest value of `a`: a curve with a
 * small one is not seen beside the other. */
double sf_plot_difference(const sf_series *a, const sf_series *b, const double range[2]);

enum { SF_INSTANTS = 3 };

/* A picture of report.html. */
typedef struct sf_report_picture {
    char *svg;      /* the SVG element, owned; NULL: it cannot be made */
    char text[400]; /* what it shows, or why there is none */
} sf_report_picture;

typedef struct sf_report_pictures {
    sf_report_picture before, pad, instants, profile, force, energies;
} sf_report_pictures;

/* The pad before a later drop of a series, as its foam is softened; none if the file does not hold it, or on
 * failure. `*picture` is zero before. */
void sf_report_picture_before(const sf_results *results, sf_report_picture *picture, sf_error *err);

/* After history.csv. Release with sf_report_pictures_free, also after a failure (of memory or of a file). */
sf_status sf_report_pictures_make(const sf_staging *output, const sf_results *results,
                                  const sf_figures *figures, sf_report_pictures *pictures, sf_error *err);
void sf_report_pictures_free(sf_report_pictures *pictures);

/* summary.json, and the short table that softfall-post prints. Keys carry their units; a figure that the run
 * does not define is null. docs/formats.md lists the keys. */

sf_status sf_summary_write(const sf_staging *output, const sf_summary *summary, sf_error *err);

/* The verdict, its rows that are not valid, and the table on `out`; the last line says that the figures are
 * indicative. */
void sf_summary_print(FILE *out, const sf_summary *summary);

/* The material and the case in a report, from their texts (post/results/results.h). */

/* The section Material: the keys that the case gives, and the comments of the material. */
void sf_origin_put_material(FILE *page, const char *case_text, const char *parameters);

/* Rows with the values of keys, each given as key and title, until a key is NULL; without the brackets of the
 * case's syntax, and none for a key that is absent. */
void sf_origin_put_keys(sf_html_table *table, const char *parameters, const sf_named_text *list);
#define SF_ORIGIN_PUT(table, parameters, ...)                                                                \
    sf_origin_put_keys(table, parameters, (const sf_named_text[]){__VA_ARGS__, {0}})

/* The pages of a drop share its title, the findings (why the verdict is not "valid"; `line` has
 * SF_VERDICT_LINE_SIZE bytes) and the kind of sf_html_banner. */
enum { SF_REPORT_TITLE_SIZE = 160 };
void sf_report_title(const sf_results *results, char *title, size_t size);
const char *sf_report_findings(const sf_verdict *verdict, char *line, size_t size);
const char *sf_report_kind(sf_grade grade);

/* report.html: one page to hand on, self-contained, usually two sides of A4: verdict, what was dropped on
 * what, the deformed pad at the peak, the mid-section at three instants, curves, figures, material, mesh and
 * where it all comes from. A picture that cannot be made is replaced by the reason. */

/* After sf_plot_write, whose picture the page takes in. */
sf_status sf_report_write(const sf_staging *output, const sf_summary *summary, sf_error *err);

/* The ready state for ParaView, pad_paraview.py beside pad.xdmf: share/softfall/pad_paraview.py with the
 * facts of the drop in it; and the film and the picture that it makes. */

/* The text of a file that comes with softfall in share/softfall, from malloc, owned by the caller. SF_ERR_IO:
 * it is missing, or does not hold `mark`, where the facts of a drop go. */
sf_status sf_template_read(const char *name, const char *mark, char **text, sf_error *err);

/* After pad.xdmf, if that has frames. `warning` (size bytes) says that the template is missing or another
 * one, and there is no state; or that the planes of a half or quarter model cannot be told, and the state
 * shows the modelled part only. Else it is "". */
sf_status sf_paraview_write(const sf_staging *output, const sf_results *results, const sf_xdmf *made,
                            char *warning, size_t size, sf_error *err);

/* Before anything is computed: "pad.mp4" or "pad.gif" of the word "mp4" or "gif" (NULL: mp4), and are the
 * programs there that make it? SF_ERR_INPUT with the package that is missing. */
sf_status sf_paraview_check_film(const char *kind, const char **film, sf_error *err);

/* The film and pad.png, the picture at the peak, in the staging directory, by the state there. */
sf_status sf_paraview_film(const sf_staging *output, const char *film, sf_error *err);

/* view.html: the drop in a browser, one page without anything to load: share/softfall/view.html with the
 * facts and arrays of the drop in it as JSON. Numbers of the arrays have 16 bits between the least and the
 * largest value of a frame; the page states the error. */

enum { SF_BROWSER_MOST_MB = 200 }; /* beyond that a browser may have no memory for it */

/* After pad.xdmf; before report.html, which links it. The page has at most so many MB: fewer frames than
 * there are, or the skin without the inside; the page says so. `warning` (size bytes) says why there is no
 * page, or is ""; with 0 MB, or without frames, there is none and no warning. */
sf_status sf_browser_write(const sf_staging *output, const sf_summary *summary, const sf_xdmf *made,
                           double megabytes, char *warning, size_t size, sf_error *err);

/* softfall-post compare A B ... -o DIR: several runs in one picture and one table. softfall-post series: the
 * drops of a series on one pad, with their growth and mean. */

/* The program with this command; returns its exit code. argv[1] is "compare" or "series". */
int sf_overlay_main(int argc, char **argv);
