/* What FMI 2.0 and 3.0 have in common: how functions are exported, and those that differ in their name alone. It stands in the
 * file of a version behind its Status, its Instance, and what it says of a result. */

#if defined _WIN32 || defined __CYGWIN__
#define EXPORT __declspec(dllexport)
#elif defined __GNUC__
#define EXPORT __attribute__((visibility("default")))
#else
#define EXPORT
#endif

/* Functions that are linked together with those of other FMUs begin with the name of the model. */
#ifdef FUNCTION_PREFIX
#define JOINED(prefix, name) prefix##name
#define JOIN(prefix, name) JOINED(prefix, name)
#define FMI(name) JOIN(FUNCTION_PREFIX, name)
#else
#define FMI(name) name
#endif

/* There is nothing of a kind. */
static Status none(Instance *of, size_t count)
{
    return said(of, count == 0 ? OK : UNKNOWN_VARIABLE);
}

EXPORT Status FMI(OF_VERSION(ExitInitializationMode))(void *c) { (void)c; return STATUS_OK; }
EXPORT Status FMI(OF_VERSION(EnterEventMode))(void *c) { (void)c; return STATUS_OK; }
EXPORT Status FMI(OF_VERSION(EnterContinuousTimeMode))(void *c) { (void)c; return STATUS_OK; }
EXPORT Status FMI(OF_VERSION(Terminate))(void *c) { (void)c; return STATUS_OK; }

EXPORT Status FMI(OF_VERSION(Reset))(void *c)
{
    core_reset(&((Instance *)c)->core);
    return STATUS_OK;
}

EXPORT Status FMI(OF_VERSION(SetTime))(void *c, double time)
{
    ((Instance *)c)->core.now.time = time;
    return STATUS_OK;
}

EXPORT Status FMI(OF_VERSION(SetContinuousStates))(void *c, const double x[], size_t count)
{
    return said(c, core_set_states(&((Instance *)c)->core, x, count));
}

EXPORT Status FMI(OF_VERSION(GetContinuousStates))(void *c, double x[], size_t count)
{
    return said(c, core_get_states(&((Instance *)c)->core, x, count));
}

EXPORT Status FMI(OF_VERSION(GetEventIndicators))(void *c, double indicators[], size_t count)
{
    return said(c, core_get_kinks(&((Instance *)c)->core, indicators, count));
}

EXPORT Status FMI(OF_VERSION(GetNominalsOfContinuousStates))(void *c, double nominals[], size_t count)
{
    return said(c, core_get_nominals(nominals, count));
}
