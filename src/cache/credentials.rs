//! Who asks a shared cache, from the usual places: the environment, and the files of the AWS tools.

use std::path::PathBuf;

use rusty_s3::Credentials;

/// A variable of the environment that says something.
fn variable(name: &str) -> Option<String> {
    std::env::var(name).ok().filter(|value| !value.is_empty())
}

/// The whole value of the `Authorization` header for an HTTP server.
pub(super) fn authorization() -> Option<String> {
    variable("KILN_REMOTE_AUTHORIZATION")
}

/// The region of an object store.
pub(super) fn region() -> String {
    variable("AWS_REGION")
        .or_else(|| variable("AWS_DEFAULT_REGION"))
        .unwrap_or_else(|| "us-east-1".to_owned())
}

/// The address of an object store that is not Amazon's.
pub(super) fn endpoint() -> Option<String> {
    variable("AWS_ENDPOINT_URL_S3").or_else(|| variable("AWS_ENDPOINT_URL"))
}

/// Key and secret of an object store: of the environment, else of the profile in the credentials file. None asks without a name.
pub(super) fn of_store() -> Option<Credentials> {
    if let (Some(key), Some(secret)) = (variable("AWS_ACCESS_KEY_ID"), variable("AWS_SECRET_ACCESS_KEY")) {
        return Some(credentials(key, secret, variable("AWS_SESSION_TOKEN")));
    }
    let file = variable("AWS_SHARED_CREDENTIALS_FILE").map(PathBuf::from).or_else(|| {
        let home = variable("HOME").or_else(|| variable("USERPROFILE"))?;
        Some(PathBuf::from(home).join(".aws").join("credentials"))
    })?;
    let profile = variable("AWS_PROFILE").unwrap_or_else(|| "default".to_owned());
    of_profile(&std::fs::read_to_string(file).ok()?, &profile)
}

fn credentials(key: String, secret: String, token: Option<String>) -> Credentials {
    match token {
        Some(token) => Credentials::new_with_token(key, secret, token),
        None => Credentials::new(key, secret),
    }
}

/// What a credentials file says of a profile. Source: AWS CLI User Guide, 2025, "Configuration and credential file settings".
fn of_profile(text: &str, profile: &str) -> Option<Credentials> {
    let header = format!("[{profile}]");
    let lines = text.lines().map(str::trim).skip_while(|line| *line != header).skip(1);
    let lines: Vec<&str> = lines.take_while(|line| !line.starts_with('[')).collect();
    let value = |name: &str| {
        let pairs = lines.iter().filter_map(|line| line.split_once('='));
        pairs.map(|(key, value)| (key.trim(), value.trim())).find(|(key, _)| *key == name)
    };
    let text = |name: &str| value(name).map(|(_, value)| value.to_owned());
    Some(credentials(text("aws_access_key_id")?, text("aws_secret_access_key")?, text("aws_session_token")))
}

#[cfg(test)]
mod tests {
    use super::of_profile;

    #[test]
    fn a_profile_of_the_file_is_read() {
        let text = "[default]\naws_access_key_id = A\naws_secret_access_key = B\n\n[farm]\naws_access_key_id=C\n\
                    # a comment\naws_secret_access_key = D=E\naws_session_token = F\n";
        let found = |profile: &str| {
            of_profile(text, profile)
                .map(|one| (one.key().to_owned(), one.secret().to_owned(), one.token().map(str::to_owned)))
        };
        let owned = str::to_owned;
        assert_eq!(found("default"), Some((owned("A"), owned("B"), None)));
        assert_eq!(found("farm"), Some((owned("C"), owned("D=E"), Some(owned("F")))));
        assert_eq!(found("none"), None);
        assert!(of_profile("[default]\naws_access_key_id = A\n", "default").is_none());
    }
}
