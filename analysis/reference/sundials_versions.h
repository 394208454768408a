/* What changed between SUNDIALS 6 and 7. */
#ifndef SUNDIALS_VERSIONS_H
#define SUNDIALS_VERSIONS_H
#include <sundials/sundials_config.h>
#include <sundials/sundials_context.h>

#if SUNDIALS_VERSION_MAJOR >= 7
#define REF_CREATE_CONTEXT(context) SUNContext_Create(SUN_COMM_NULL, context)
#define REF_SILENCE_CVODE(context, memory) ((void)(memory), SUNContext_ClearErrHandlers(context))
#define REF_SILENCE_KINSOL(context, memory) ((void)(memory), SUNContext_ClearErrHandlers(context))
#else
#define REF_CREATE_CONTEXT(context) SUNContext_Create(NULL, context)
#define REF_SILENCE_CVODE(context, memory) ((void)(context), CVodeSetErrFile(memory, NULL))
#define REF_SILENCE_KINSOL(context, memory) ((void)(context), KINSetErrFile(memory, NULL))
#endif
#endif
