/* backend.h - is the machine that particles live on there, and does it work? */
#ifndef BACKEND_H
#define BACKEND_H
#include "../base/status.h"
#ifdef __cplusplus
extern "C" {
#endif

/* Called before particle memory is first taken, and whenever somebody wants to know. Errors:
 * ERR_SKIPPED where no GPU is there that this variant can use; ERR_RUN once the GPU failed, in a
 * sweep for example, with the place and the reason (what is computed after that means nothing). On
 * the host always OK. */
status backend_check(void);

#ifdef __cplusplus
}
#endif
#endif
