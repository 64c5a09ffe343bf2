import { Button, Center, MantineProvider, Stack, Text } from "@mantine/core";
import { QueryClientProvider } from "@tanstack/react-query";
import { lazy, Suspense } from "react";
import { Link, Route, Switch } from "wouter";
import { queryClient } from "../api/queries";
import { text } from "../strings";
import { ConnectionBanner } from "./ConnectionBanner";
import { CrashBoundary } from "./CrashBoundary";
import { LoadedReview } from "./LoadedReview";
import { theme } from "./theme";

const DrivesPage = lazy(() => import("../drives/DrivesPage").then((module) => ({ default: module.DrivesPage })));
const EvaluationPage = lazy(() =>
  import("../evaluation/EvaluationPage").then((module) => ({ default: module.EvaluationPage })),
);
const SummaryPage = lazy(() => import("../summary/SummaryPage").then((module) => ({ default: module.SummaryPage })));

export function App() {
  return (
    <MantineProvider theme={theme} defaultColorScheme="auto">
      <QueryClientProvider client={queryClient}>
        <ConnectionBanner />
        <CrashBoundary>
          <Switch>
            <Route path="/">
              <Suspense fallback={null}>
                <DrivesPage />
              </Suspense>
            </Route>
            <Route path="/drives/:id">
              {({ id }) => (
                <Suspense fallback={null}>
                  {/^\d+$/.test(id) ? <LoadedReview key={id} driveId={Number(id)} /> : <NotFound />}
                </Suspense>
              )}
            </Route>
            <Route path="/drives/:id/evaluation">
              {({ id }) => (
                <Suspense fallback={null}>
                  {/^\d+$/.test(id) ? <EvaluationPage key={id} driveId={Number(id)} /> : <NotFound />}
                </Suspense>
              )}
            </Route>
            <Route path="/drives/:id/summary">
              {({ id }) => (
                <Suspense fallback={null}>
                  {/^\d+$/.test(id) ? <SummaryPage key={id} driveId={Number(id)} /> : <NotFound />}
                </Suspense>
              )}
            </Route>
            <Route component={NotFound} />
          </Switch>
        </CrashBoundary>
      </QueryClientProvider>
    </MantineProvider>
  );
}

function NotFound() {
  return (
    <Center h="100%">
      <Stack align="center">
        <Text>{text.app.notFound}</Text>
        <Button component={Link} href="/">
          {text.app.backToDrives}
        </Button>
      </Stack>
    </Center>
  );
}
