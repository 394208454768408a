/* scene_file.h - scenes that a user writes in YAML (docs/scene-files.md). */
#ifndef SCENE_FILE_H
#define SCENE_FILE_H
#include "scene.h"
#ifdef __cplusplus
extern "C" {
#endif

struct scene_file;

/* Read and check a scene file; everything but overlaps is found here. Errors: ERR_USER with file,
 * line, column, key, what was found and what is allowed; ERR_MEMORY. *out is then NULL. */
status scene_file_load(const char *path, struct scene_file **out);

/* As the file says; without a name: the file's, without folder and ending. */
const char *scene_file_name(const struct scene_file *file);
const char *scene_file_about(const struct scene_file *file);  /* "" if it does not say */
const char *scene_file_source(const struct scene_file *file); /* "" if it does not say */
int scene_file_dim(const struct scene_file *file);            /* 2 or 3 */

/* Put the common parameters that the file gives into *common; the others stay as they are. */
void scene_file_defaults(const struct scene_file *file, struct scene_params *common);

/* Fill the scene, whose common parameters are final; gravity is common.gravity along the file's
 * direction. Errors: ERR_USER (a file of the other dimension, too many particles), ERR_MEMORY. */
status scene_file_build(struct scene_file *file, struct scene *scene);

void scene_file_free(struct scene_file *file); /* NULL is allowed */

#ifdef __cplusplus
}
#endif
#endif
